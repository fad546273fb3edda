//! `sample.csv`: trajectories of at most [`SAMPLED`] vehicles, drawn evenly from all that ever depart.
//!
//! How many will depart is not known before the end. So a number is drawn for every vehicle from the seed and its id, and
//! the vehicles with the smallest numbers so far are followed (bottom-k sampling: Cohen and Kaplan 2007). A vehicle that
//! is pushed out never comes back, so those that are left at the end were followed from their departure on. The points
//! go to an unnamed file meanwhile, so memory does not grow with time; about k·(1 + ln(n/k)) of n vehicles pass through it.

use super::rows::{PlaceColumns, SAMPLE, SampleRow};
use crate::output::{OutputError, Table, file_error};
use crate::random::Stream;
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::Seek;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Vehicles in `sample.csv`.
pub const SAMPLED: usize = 200;

/// One point in the unnamed file: the vehicle's number, time, speed, target, distance, torque, and its place.
type Point = (u64, [f64; 5], ([Option<f64>; 3], Option<String>));

/// Follows a sample of the vehicles.
#[derive(Debug)]
pub struct Sampler {
    seed: u64,
    path: PathBuf,
    limit: usize,
    /// The followed vehicles by their draw; draws in [0, 1) are ordered as their bits are.
    followed: BTreeMap<(u64, Arc<str>), u64>,
    numbers: HashMap<Arc<str>, u64>,
    next: u64,
    points: csv::Writer<File>,
}

impl Sampler {
    /// A sample of at most `limit` vehicles for the file at `path`, drawn with the run's seed.
    ///
    /// # Errors
    /// [`OutputError::File`] if no file can be made in the folder of `path`.
    pub fn create(path: &Path, seed: u64, limit: usize) -> Result<Self, OutputError> {
        let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let points = tempfile::tempfile_in(folder).map_err(file_error("create a file in", folder))?;
        Ok(Self {
            seed,
            path: path.to_owned(),
            limit,
            followed: BTreeMap::new(),
            numbers: HashMap::new(),
            next: 0,
            points: csv::Writer::from_writer(points),
        })
    }

    /// A vehicle departed.
    pub fn depart(&mut self, id: &Arc<str>) {
        let draw = (Stream::new(self.seed, "sample", id).uniform().to_bits(), id.clone());
        if self.followed.len() >= self.limit && self.followed.last_key_value().is_some_and(|(last, _)| draw > *last) {
            return;
        }
        self.numbers.insert(id.clone(), self.next);
        self.followed.insert(draw, self.next);
        self.next += 1;
        if self.followed.len() > self.limit
            && let Some(((_, out), _)) = self.followed.pop_last()
        {
            self.numbers.remove(&out);
        }
    }

    /// Whether a vehicle is followed at present.
    pub fn follows(&self, id: &str) -> bool {
        self.numbers.contains_key(id)
    }

    /// Takes the present point of a vehicle, if it is followed.
    ///
    /// # Errors
    /// [`OutputError::File`] naming the table, e.g. when the disk is full.
    pub fn write(&mut self, row: &SampleRow) -> Result<(), OutputError> {
        let Some(number) = self.numbers.get(&row.id) else { return Ok(()) };
        let PlaceColumns { x, y, angle, lane } = row.place.clone();
        let numbers = [row.time, row.speed, row.target, row.distance, row.torque];
        let point: Point = (*number, numbers, ([x, y, angle], lane));
        self.points.serialize(point).map_err(|e| file_error("write", &self.path)(e.into()))
    }

    /// Writes the table: the points of those who are left, in the order of time.
    ///
    /// # Errors
    /// As [`Table::create`] and [`Table::write`].
    pub fn finish(self) -> Result<PathBuf, OutputError> {
        let Self { path, followed, points, .. } = self;
        let ids: HashMap<u64, Arc<str>> = followed.into_iter().map(|((_, id), number)| (number, id)).collect();
        let mut points = points.into_inner().map_err(|e| file_error("write", &path)(e.into_error()))?;
        points.rewind().map_err(file_error("read", &path))?;
        let mut table = Table::create(&path, &SAMPLE)?;
        for point in csv::ReaderBuilder::new().has_headers(false).from_reader(points).deserialize() {
            let (number, [time, speed, target, distance, torque], ([x, y, angle], lane)): Point =
                point.map_err(|e| file_error("read", &path)(e.into()))?;
            let place = PlaceColumns { x, y, angle, lane };
            if let Some(id) = ids.get(&number) {
                table.write(&SampleRow { time, id: id.clone(), speed, target, distance, torque, place })?;
            }
        }
        table.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vehicle k departs at k seconds and drives for 20 s; returns the lines of the table.
    fn run(seed: u64, vehicles: u32, limit: usize) -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        let mut sampler = Sampler::create(&folder.path().join("sample.csv"), seed, limit).unwrap();
        let ids: Vec<Arc<str>> = (0..vehicles).map(|k| format!("veh{k}").into()).collect();
        for time in 0..vehicles + 20 {
            if let Some(id) = ids.get(time as usize) {
                sampler.depart(id);
            }
            for k in time.saturating_sub(19)..=time.min(vehicles - 1) {
                let (time, distance) = (f64::from(time), f64::from(time - k));
                let id = ids[k as usize].clone();
                // It has no place in every third second, as while SUMO carries it.
                let lane = (!(time as u32).is_multiple_of(3)).then(|| "a,\"b\"_0".to_owned());
                let place = PlaceColumns { x: lane.as_ref().map(|_| 0.5), lane, ..PlaceColumns::default() };
                let (speed, target, torque) = (1.0, 1.0, -2.5);
                sampler.write(&SampleRow { time, id, speed, target, distance, torque, place }).unwrap();
            }
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "the points have no name");
        let text = std::fs::read_to_string(sampler.finish().unwrap()).unwrap();
        text.lines().map(str::to_owned).collect()
    }

    fn followed(lines: &[String]) -> BTreeMap<String, usize> {
        let ids = lines[1..].iter().map(|line| line.split(',').nth(1).unwrap().to_owned());
        ids.fold(BTreeMap::new(), |mut counts, id| {
            *counts.entry(id).or_default() += 1;
            counts
        })
    }

    #[test]
    fn law_whoever_is_in_the_sample_is_there_from_departure_to_arrival() {
        let lines = run(42, 300, 10);
        assert_eq!(lines[0], "time,id,speed,target,distance,torque,x,y,angle,lane");
        let counts = followed(&lines);
        assert_eq!(counts.len(), 10);
        assert!(counts.values().all(|n| *n == 20), "{counts:?}");
        let times: Vec<f64> = lines[1..].iter().map(|l| l.split(',').next().unwrap().parse().unwrap()).collect();
        assert!(times.is_sorted());
        let places = |line: &String| {
            let (_, place) = line.split_once(",-2.5,").expect("the torque");
            let time: f64 = line.split(',').next().unwrap().parse().unwrap();
            assert_eq!(
                place,
                if !(time as u32).is_multiple_of(3) { "0.5,,,\"a,\"\"b\"\"_0\"" } else { ",,," },
                "{line}"
            );
        };
        lines[1..].iter().for_each(places);
    }

    #[test]
    fn law_the_sample_comes_from_the_seed_and_from_the_whole_run() {
        assert_eq!(run(42, 300, 10), run(42, 300, 10));
        assert_ne!(followed(&run(42, 300, 10)), followed(&run(43, 300, 10)));
        // Over 40 seeds each half of the departures holds about half of the 400 sampled vehicles (sd 10).
        let late: usize = (0..40)
            .flat_map(|seed| followed(&run(seed, 100, 10)).into_keys())
            .filter(|id| id[3..].parse::<u32>().unwrap() >= 50)
            .count();
        assert!((160..=240).contains(&late), "{late} of 400");
    }

    #[test]
    fn fewer_vehicles_than_places_are_all_followed() {
        assert_eq!(followed(&run(1, 7, 10)).len(), 7);
    }
}
