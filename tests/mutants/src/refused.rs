//! The changes that the compiler has refused, remembered for as long as their files stay as they are: to find them takes
//! several builds.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use crate::list::Mutant;

/// What is refused, by number, and the file that remembers it.
pub struct Refused {
    pub numbers: BTreeSet<u32>,
    file: PathBuf,
    /// How each change is named in the file: with a digest of the code that it changes.
    keys: Vec<String>,
}

impl Refused {
    /// Reads what was refused of these changes of the code in `root` before.
    ///
    /// # Errors
    /// When a changed file cannot be read.
    pub fn read(file: PathBuf, root: &Path, mutants: &[Mutant]) -> std::io::Result<Self> {
        let mut digests: HashMap<&str, u64> = HashMap::new();
        for mutant in mutants {
            if !digests.contains_key(mutant.file.as_str()) {
                let mut hasher = DefaultHasher::new();
                fs::read(root.join(&mutant.file))?.hash(&mut hasher);
                digests.insert(&mutant.file, hasher.finish());
            }
        }
        let key = |mutant: &Mutant| format!("{:016x} {}", digests[mutant.file.as_str()], mutant.name);
        let keys: Vec<String> = mutants.iter().map(key).collect();
        let before: HashSet<String> = fs::read_to_string(&file).unwrap_or_default().lines().map(String::from).collect();
        let numbers = (1..).zip(&keys).filter(|(_, key)| before.contains(*key)).map(|(number, _)| number).collect();
        Ok(Self { numbers, file, keys })
    }

    /// Adds what was refused now, and writes it down.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn extend(&mut self, numbers: impl IntoIterator<Item = u32>) -> std::io::Result<()> {
        let before = self.numbers.clone();
        self.numbers.extend(numbers);
        let new = self.numbers.difference(&before).map(|number| format!("{}\n", self.keys[*number as usize - 1]));
        let text = fs::read_to_string(&self.file).unwrap_or_default() + &new.collect::<String>();
        fs::write(&self.file, text)
    }
}
