//! The rows of a run, completed with what SUMO's tripinfo has of the same vehicles, in the order of the files. Both are
//! sorted on disk: memory does not grow with the number of vehicles.

use super::noted::{Noted, Texts};
use super::rows::{QUALITY, VEHICLES, milliseconds};
use crate::cosim::Reason;
use crate::output::{Item, OutputError, Sorted, Sorter, append, file_error};
use crate::scenario::Scenario;
use crate::sumo_files::{SumoFileError, TripInfo, each_trip};
use crate::table::Cell;
use std::io;
use std::path::{Path, PathBuf};

/// SUMO's trips by id.
pub struct SortedTrips {
    trips: Sorted,
    /// How many there are.
    pub count: u64,
    /// False if the file breaks off.
    pub whole: bool,
}

/// What the rows need of a trip.
#[derive(Debug, Clone, PartialEq)]
struct Trip {
    depart_s: f64,
    arrival_s: Option<f64>,
    time_loss_s: f64,
    taken_out: Option<String>,
}

/// The rows, and what they and all trips come to.
pub struct Joined {
    rows: Sorted,
    folder: PathBuf,
    /// How many trips ended with an arrival, and their mean time loss \[s\].
    pub arrivals: (u64, Option<f64>),
}

/// A key that is ordered by id, then by the order of coming.
pub(super) fn by_id(id: &str, nth: u64) -> Vec<u8> {
    [id.as_bytes(), &[0], &nth.to_be_bytes()].concat()
}

fn id_of(key: &[u8]) -> &[u8] {
    &key[..key.len() - 9]
}

/// A key that is ordered by departure, then by id.
pub(super) fn by_departure(depart_s: f64, by_id: &[u8]) -> Vec<u8> {
    let bits = depart_s.to_bits();
    // Ordered as `f64::total_cmp` does.
    let ordered = if bits >> 63 == 1 { !bits } else { bits | 1 << 63 };
    [&ordered.to_be_bytes()[..], by_id].concat()
}

impl SortedTrips {
    /// No trips.
    pub fn none(folder: &Path) -> Self {
        Self { trips: Sorter::new(folder).sorted(), count: 0, whole: true }
    }

    /// Reads a tripinfo output.
    ///
    /// # Errors
    /// A file that cannot be read; or a disk that is full.
    pub fn read(path: &Path, folder: &Path) -> Result<Result<Self, SumoFileError>, OutputError> {
        let (mut trips, mut count, mut full) = (Sorter::new(folder), 0, None);
        let whole = each_trip(path, |id, trip| {
            let pushed = trips.push(by_id(&id, count), Trip::of(trip).bytes());
            count += 1;
            pushed.map_err(|error| {
                let said = error.to_string();
                full = Some(error);
                said
            })
        });
        match full {
            Some(error) => Err(file_error("write a file in", folder)(error)),
            None => Ok(whole.map(|whole| Self { trips: trips.sorted(), count, whole })),
        }
    }
}

impl Trip {
    fn of(trip: TripInfo) -> Self {
        let TripInfo { depart_s, arrival_s, time_loss_s, taken_out, .. } = trip;
        Self { depart_s, arrival_s, time_loss_s, taken_out }
    }

    fn bytes(&self) -> Vec<u8> {
        let numbers = [self.depart_s, self.time_loss_s, self.arrival_s.unwrap_or(f64::NAN)];
        let mut bytes: Vec<u8> = numbers.into_iter().flat_map(f64::to_le_bytes).collect();
        if let Some(taken_out) = &self.taken_out {
            bytes.push(1);
            bytes.extend(taken_out.bytes());
        }
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Self {
        let number = |place: usize| f64::from_le_bytes(bytes[8 * place..][..8].try_into().expect("eight bytes"));
        let taken_out = bytes[24..].split_first().map(|(_, text)| String::from_utf8_lossy(text).into_owned());
        let arrival_s = Some(number(2)).filter(|arrival_s| !arrival_s.is_nan());
        Self { depart_s: number(0), time_loss_s: number(1), arrival_s, taken_out }
    }
}

/// Texts as bytes, each with its length.
pub(super) fn packed<'t>(texts: impl IntoIterator<Item = &'t String>) -> Vec<u8> {
    let mut bytes = Vec::new();
    for text in texts {
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.bytes());
    }
    bytes
}

/// The texts of [`packed`].
pub(super) fn unpacked(mut bytes: &[u8]) -> Vec<String> {
    let mut texts = Vec::new();
    while let Some((length, rest)) = bytes.split_first_chunk() {
        let (text, rest) = rest.split_at(u32::from_le_bytes(*length) as usize);
        bytes = rest;
        texts.push(String::from_utf8_lossy(text).into_owned());
    }
    texts
}

fn pack_rows(rows: &Texts) -> Vec<u8> {
    packed(rows.iter().flatten())
}

fn unpack_rows(bytes: &[u8]) -> Texts {
    let mut vehicle = unpacked(bytes);
    let quality = vehicle.split_off(VEHICLES.shape.columns.len());
    [vehicle, quality]
}

/// Where the columns stand that a trip has a say in.
struct Places {
    depart: usize,
    arrival: usize,
    duration: usize,
    timeloss: usize,
    reason: usize,
    complete: usize,
    quality_depart: usize,
}

impl Places {
    fn new() -> Self {
        let place = |name| VEHICLES.place(name).expect("the table of vehicles has this column");
        Self {
            depart: place("depart"),
            arrival: place("arrival"),
            duration: place("duration"),
            timeloss: place("timeloss"),
            reason: place("reason"),
            complete: place("complete"),
            quality_depart: QUALITY.place("depart").expect("so has that of their quality"),
        }
    }

    /// Completes the rows of a vehicle with its trip; gives its departure \[s\].
    fn complete(&self, [vehicle, quality]: &mut Texts, trip: Option<&Trip>, end_s: f64) -> f64 {
        let number = |text: &str| text.parse::<f64>().ok();
        let noted_s = number(&vehicle[self.depart]).unwrap_or(0.0);
        let depart_s = milliseconds(trip.map_or(noted_s, |trip| trip.depart_s));
        let taken_out = trip.and_then(|trip| trip.taken_out.as_deref());
        let reason = match (vehicle[self.reason].as_str(), taken_out) {
            // TraCI calls all of them arrived, or (SUMO 1.15) nothing at all.
            ("arrived" | "removed", Some("collision")) => Reason::Collided.as_str(),
            ("arrived" | "removed", Some("teleport")) => Reason::TeleportedOut.as_str(),
            ("arrived", Some(_)) => Reason::Removed.as_str(),
            (reason, _) => reason,
        }
        .to_owned();
        let ended_s = trip.and_then(|trip| trip.arrival_s).or(number(&vehicle[self.arrival]));
        let has_arrival = ![Reason::Removed, Reason::Collided].iter().any(|other| other.as_str() == reason);
        let time_loss_s = number(&vehicle[self.timeloss]).or(trip.map(|trip| trip.time_loss_s));
        let set = |text: &mut String, value: Option<f64>| {
            text.clear();
            append(text, Cell::Number(value.filter(|value| value.is_finite())));
        };
        set(&mut vehicle[self.depart], Some(depart_s));
        set(&mut vehicle[self.arrival], ended_s.filter(|_| has_arrival).map(milliseconds));
        set(&mut vehicle[self.duration], Some(milliseconds(ended_s.unwrap_or(end_s) - depart_s)));
        set(&mut vehicle[self.timeloss], time_loss_s);
        set(&mut quality[self.quality_depart], Some(depart_s));
        vehicle[self.complete] = (reason == Reason::Arrived.as_str()).to_string();
        vehicle[self.reason] = reason;
        depart_s
    }
}

/// The rows by id.
fn sorted_rows(noted: &Noted, scenario: &Scenario, end_s: f64, folder: &Path) -> Result<Sorted, OutputError> {
    let (mut rows, mut nth) = (Sorter::new(folder), 0);
    noted.each(scenario, end_s, |texts| {
        nth += 1;
        rows.push(by_id(&texts[0][0], nth), pack_rows(&texts)).map_err(file_error("write a file in", folder))
    })?;
    Ok(rows.sorted())
}

impl Joined {
    /// Joins the rows of a run that has ended at `end_s` with SUMO's trips. An id that was used twice takes its trips one
    /// after the other.
    ///
    /// # Errors
    /// [`OutputError::File`] if a journal cannot be read, or the disk is full.
    pub fn new(
        noted: &Noted,
        trips: SortedTrips,
        (scenario, end_s): (&Scenario, f64),
        folder: &Path,
    ) -> Result<Self, OutputError> {
        let rows = sorted_rows(noted, scenario, end_s, folder)?;
        Self::join(&rows, &trips, end_s, folder).map_err(file_error("sort the rows in", folder))
    }

    fn join(rows: &Sorted, trips: &SortedTrips, end_s: f64, folder: &Path) -> io::Result<Self> {
        let (places, mut joined) = (Places::new(), Sorter::new(folder));
        let (mut rows, mut trips) = (Ahead::of(rows.iter())?, Ahead::of(trips.trips.iter())?);
        let (mut arrived, mut loss_s) = (0_u64, -0.0);
        while let Some(id) = least(rows.id(), trips.id()) {
            let row = rows.take_if(&id)?.map(|(key, bytes)| (key, unpack_rows(&bytes)));
            let mut trip = trips.take_if(&id)?.map(|(_, bytes)| Trip::from_bytes(&bytes));
            // Of a vehicle whose body led, SUMO has the time loss against the speed factor that it was given meanwhile.
            let own_s = row.as_ref().and_then(|(_, [vehicle, _])| vehicle[places.timeloss].parse::<f64>().ok());
            if let (Some(own_s), Some(trip)) = (own_s, &mut trip) {
                trip.time_loss_s = own_s;
            }
            if let Some(trip) = trip.as_ref().filter(|trip| trip.arrival_s.is_some()) {
                arrived += 1;
                loss_s += trip.time_loss_s;
            }
            if let Some((key, mut texts)) = row {
                let depart_s = places.complete(&mut texts, trip.as_ref(), end_s);
                joined.push(by_departure(depart_s, &key), pack_rows(&texts))?;
            }
        }
        let mean_s = (arrived > 0).then(|| loss_s / arrived as f64);
        Ok(Self { rows: joined.sorted(), folder: folder.to_owned(), arrivals: (arrived, mean_s) })
    }

    /// The rows in the order of the files: by departure, then id.
    pub fn rows(&self) -> impl Iterator<Item = Result<Texts, OutputError>> {
        let read = |item: io::Result<Item>| {
            item.map(|(_, bytes)| unpack_rows(&bytes)).map_err(file_error("read a file in", &self.folder))
        };
        self.rows.iter().map(read)
    }
}

/// Items by id, one of them ahead.
struct Ahead<I> {
    items: I,
    next: Option<Item>,
}

impl<I: Iterator<Item = io::Result<Item>>> Ahead<I> {
    fn of(mut items: I) -> io::Result<Self> {
        let next = items.next().transpose()?;
        Ok(Self { items, next })
    }

    fn id(&self) -> Option<&[u8]> {
        self.next.as_ref().map(|(key, _)| id_of(key))
    }

    /// The next item, if it is of this id.
    fn take_if(&mut self, id: &[u8]) -> io::Result<Option<Item>> {
        if self.id() != Some(id) {
            return Ok(None);
        }
        let following = self.items.next().transpose()?;
        Ok(std::mem::replace(&mut self.next, following))
    }
}

fn least(a: Option<&[u8]>, b: Option<&[u8]>) -> Option<Vec<u8>> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b).to_vec()),
        (a, b) => a.or(b).map(<[u8]>::to_vec),
    }
}

#[cfg(test)]
mod tests {
    use super::super::rows::VehicleRow;
    use super::super::rows::tests::vehicle;
    use super::*;
    use crate::output::texts;

    /// Rows in the order of leaving, joined with trips in the order of SUMO's file.
    fn joined(rows: &[VehicleRow], trips: &[(&str, Trip)]) -> Joined {
        let folder = Path::new("/nowhere");
        let (mut by_ids, mut of_sumo) = (Sorter::new(folder), Sorter::new(folder));
        let quality = vec!["".to_owned(); QUALITY.shape.columns.len()];
        for (nth, row) in rows.iter().enumerate() {
            let texts = [texts(&VEHICLES, row), quality.clone()];
            assert_eq!(unpack_rows(&pack_rows(&texts)), texts);
            by_ids.push(by_id(&row.id, nth as u64), pack_rows(&texts)).unwrap();
        }
        for (nth, (id, trip)) in trips.iter().enumerate() {
            assert_eq!(Trip::from_bytes(&trip.bytes()), *trip);
            of_sumo.push(by_id(id, nth as u64), trip.bytes()).unwrap();
        }
        let trips = SortedTrips { trips: of_sumo.sorted(), count: 0, whole: true };
        Joined::join(&by_ids.sorted(), &trips, 100.0, folder).unwrap()
    }

    fn trip(depart_s: f64, arrival_s: Option<f64>, taken_out: Option<&str>) -> Trip {
        Trip { depart_s, arrival_s, time_loss_s: 3.5, taken_out: taken_out.map(str::to_owned) }
    }

    fn columns(joined: &Joined, names: [&str; 5]) -> Vec<[String; 5]> {
        let place = names.map(|name| VEHICLES.place(name).unwrap());
        joined.rows().map(|row| place.map(|place| row.as_ref().unwrap()[0][place].clone())).collect()
    }

    #[test]
    fn rows_take_their_trips_and_come_by_departure() {
        let on_foot = VehicleRow { timeloss: None, arrival: None, reason: Reason::Running, ..vehicle("b", 20.0) };
        let again = VehicleRow { timeloss: None, ..vehicle("a", 30.0) };
        let first = VehicleRow { timeloss: None, ..vehicle("a", 5.0) };
        let joined = joined(
            &[first, again, on_foot, vehicle("ab", 5.0)],
            &[
                ("c", trip(1.0, Some(2.0), None)),
                ("a", trip(4.9, Some(64.8), None)),
                ("a", trip(30.0, None, Some("collision"))),
                ("ab", trip(5.0, Some(65.0), None)),
            ],
        );
        assert_eq!(
            columns(&joined, ["id", "depart", "arrival", "duration", "timeloss"]),
            [
                ["a", "4.9", "64.8", "59.9", "3.5"],
                ["ab", "5", "65", "60", "12.5"],
                ["b", "20", "", "80", ""],
                ["a", "30", "", "60", "3.5"],
            ]
        );
        let reasons = columns(&joined, ["reason", "complete", "id", "type", "target"]).into_iter();
        let reasons: Vec<_> = reasons.map(|[reason, complete, ..]| [reason, complete]).collect();
        assert_eq!(reasons, [["arrived", "true"], ["arrived", "true"], ["running", "false"], ["collided", "false"]]);
        // That of "ab" is its own, and c is no ego.
        assert_eq!(joined.arrivals, (3, Some((3.5 + 12.5 + 3.5) / 3.0)));
        assert_eq!(joined.rows().next().unwrap().unwrap()[1][QUALITY.place("depart").unwrap()], "4.9");
    }

    #[test]
    fn sumo_says_why_it_took_a_vehicle_out_whatever_traci_called_it() {
        let of = |reason: Reason, taken_out: Option<&str>| {
            let rows = [VehicleRow { reason, ..vehicle("a", 5.0) }];
            let joined = joined(&rows, &[("a", trip(5.0, None, taken_out))]);
            columns(&joined, ["reason"; 5])[0][0].clone()
        };
        for (reason, taken_out, wanted) in [
            (Reason::Arrived, Some("collision"), "collided"),
            (Reason::Removed, Some("collision"), "collided"),
            (Reason::Arrived, Some("teleport"), "teleported_out"),
            (Reason::Removed, Some("teleport"), "teleported_out"),
            (Reason::Arrived, Some("calibrator"), "removed"),
            (Reason::Removed, Some("calibrator"), "removed"),
            (Reason::Diverged, Some("collision"), "diverged"),
            (Reason::Arrived, None, "arrived"),
        ] {
            assert_eq!(of(reason, taken_out), wanted, "{reason:?}, {taken_out:?}");
        }
    }

    #[test]
    fn law_keys_are_ordered_as_the_files_are() {
        let times = [f64::NEG_INFINITY, -2.5, -0.0, 0.0, 1e-300, 7.0, 1e9];
        let keys: Vec<_> = times.iter().map(|time_s| by_departure(*time_s, &by_id("x", 0))).collect();
        assert!(keys.is_sorted());
        let ids = ["", "a", "a b", "ab", "b", "\u{fc}"];
        let keys: Vec<_> = ids.iter().flat_map(|id| [by_id(id, 3), by_id(id, 300)]).collect();
        assert!(keys.is_sorted() && id_of(&keys[4]) == b"a b");
    }
}
