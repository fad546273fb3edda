macro_rules! declared {
    ($($name:ident)*) => { $(pub mod $name;)* };
}
declared! { hidden }

const LIMIT: u32 = 10 + 8;

pub fn is_adult(age: u32) -> bool {
    age >= LIMIT
}

pub fn price(age: u32) -> f64 {
    match age {
        0..6 => 0.0,
        65.. if !is_young(age) => 2.5,
        _ => 5.0,
    }
}

fn is_young(age: u32) -> bool {
    age < 30
}

pub struct Sum {
    pub total: f64,
    pub count: u32,
}

impl Default for Sum {
    fn default() -> Self {
        Self { total: 0.0, count: 7 }
    }
}

impl Sum {
    pub fn ten() -> Self {
        Self { count: 10, ..Self::default() }
    }

    pub fn add(&mut self, a: f64, b: f64) {
        self.total += -(a * b);
        self.count += 1;
    }
}

/// A change that makes this go on for ever is found by the time.
pub fn steps(count: u32) -> u32 {
    let mut done = 0;
    while done != count {
        done += 1;
    }
    done
}

pub const fn twice(x: u32) -> u32 {
    x * 2
}

pub fn unused(words: &str) -> bool {
    words == "a" || words.len() > 3 && words != "long"
}
