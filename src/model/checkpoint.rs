//! A state as named columns, written and read by the same functions.
//!
//! Whatever has a state lists it once: the same call puts a value into a checkpoint that is being
//! saved and takes it out of one that is being loaded. What a file lacks, or has in another form,
//! is a fault; nothing is guessed.
//!
//! Several processes save one state together: what is the same everywhere the first one puts in;
//! sums, counts and largest numbers are those of all; rows that are dealt out come to the first
//! process and stand in an order that does not depend on who had them. All make the same calls.

use crate::math::exact_sum::{ExactSum, VectorSum};
use crate::parallel::Ranks;

/// A number as it stands in a column, little endian.
pub trait Number: Copy + Default {
    /// Its type, as numpy calls it.
    const KIND: &'static str;
    /// Bytes of one number.
    const BYTES: usize;

    /// Writes it; `to` has [`Number::BYTES`] bytes.
    fn put(self, to: &mut [u8]);

    /// Reads it; `from` has [`Number::BYTES`] bytes.
    fn take(from: &[u8]) -> Self;
}

macro_rules! number {
    ($type:ty, $kind:literal) => {
        impl Number for $type {
            const KIND: &'static str = $kind;
            const BYTES: usize = std::mem::size_of::<$type>();

            #[inline]
            fn put(self, to: &mut [u8]) {
                to.copy_from_slice(&self.to_le_bytes());
            }

            fn take(from: &[u8]) -> Self {
                from.try_into().map_or(Self::default(), <$type>::from_le_bytes)
            }
        }
    };
}

number!(f64, "<f8");
number!(i64, "<i8");
number!(u64, "<u8");
number!(u32, "<u4");
number!(u16, "<u2");

/// Where a column lies.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its name, with `/` between the parts.
    pub name: String,
    /// Type of its numbers, as numpy calls it.
    pub kind: String,
    /// Numbers in a row.
    pub width: usize,
    /// Number of rows.
    pub rows: usize,
    /// First byte.
    pub offset: usize,
}

impl Entry {
    /// Its bytes, if they lie within `length`.
    fn range(&self, length: usize) -> Option<std::ops::Range<usize>> {
        let kinds = [f64::KIND, i64::KIND, u64::KIND, u32::KIND, u16::KIND];
        let each = kinds.iter().position(|kind| *kind == self.kind)?;
        let each = [f64::BYTES, i64::BYTES, u64::BYTES, u32::BYTES, u16::BYTES][each];
        let size = self.rows.checked_mul(self.width)?.checked_mul(each)?;
        let end = self.offset.checked_add(size)?;
        (end <= length).then_some(self.offset..end)
    }
}

/// A state being saved or loaded.
#[derive(Clone, Debug, Default)]
pub struct Checkpoint {
    loading: bool,
    entries: Vec<Entry>,
    /// Which entries have been loaded.
    taken: Vec<bool>,
    data: Vec<u8>,
    prefix: String,
    fault: Option<String>,
    ranks: Ranks,
    /// Where the rows of the columns under way come from.
    dealt: Option<Dealt>,
}

/// A row of this process.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Its place in the columns.
    pub place: usize,
    /// Rows are saved in the order of their keys, of which no two are the same.
    pub key: [u64; 3],
}

/// Rows of several processes, or in another order than that of memory.
#[derive(Clone, Debug)]
struct Dealt {
    /// Places of the rows of this process, as they are sent.
    own: Vec<usize>,
    /// In the first process: where each row stands among all that have come.
    order: Vec<usize>,
}

impl Dealt {
    /// `None` if the rows are those in memory, in their order.
    fn new(rows: &[Row], ranks: &Ranks) -> Option<Self> {
        let sorted = rows.is_sorted_by_key(|row| row.key);
        if ranks.is_alone() && sorted && rows.iter().enumerate().all(|(at, row)| at == row.place) {
            return None;
        }
        let mut letter = Vec::with_capacity(24 * rows.len());
        rows.iter().flat_map(|row| row.key).for_each(|word| letter.extend(word.to_le_bytes()));
        let letters = match ranks.exchange() {
            Some(exchange) => exchange.gather(&letter),
            None => vec![letter],
        };
        let words = letters.iter().flat_map(|letter| letter.as_chunks::<8>().0);
        let words: Vec<u64> = words.map(|bytes| u64::from_le_bytes(*bytes)).collect();
        let keys = words.as_chunks::<3>().0;
        let mut order: Vec<usize> = (0..keys.len()).collect();
        order.sort_unstable_by_key(|row| keys[*row]);
        Some(Self { own: rows.iter().map(|row| row.place).collect(), order })
    }

    /// The bytes of a column in the first process, from those of its rows here; nothing elsewhere.
    fn collect(&self, ranks: &Ranks, own: Vec<u8>, width: usize) -> Vec<u8> {
        let all = match ranks.exchange() {
            Some(exchange) => exchange.gather(&own).concat(),
            None => own,
        };
        if all.is_empty() {
            return all;
        }
        let mut column = Vec::with_capacity(all.len());
        for row in &self.order {
            column.extend_from_slice(&all[row * width..(row + 1) * width]);
        }
        column
    }
}

impl Checkpoint {
    /// An empty checkpoint, to be filled by all processes together.
    pub fn saving(ranks: &Ranks) -> Self {
        Self { ranks: ranks.clone(), ..Self::default() }
    }

    /// What has been saved, to load it.
    ///
    /// # Errors
    /// As [`Checkpoint::loading`].
    pub fn to_load(self) -> Result<Self, String> {
        Self::loading(self.entries, self.data)
    }

    /// A checkpoint that all processes load together.
    pub fn of_ranks(self, ranks: &Ranks) -> Self {
        Self { ranks: ranks.clone(), ..self }
    }

    /// The processes that save or load it.
    pub fn ranks(&self) -> &Ranks {
        &self.ranks
    }

    /// A checkpoint to load.
    ///
    /// # Errors
    /// A column that does not lie within the data, or a name that stands there twice.
    pub fn loading(entries: Vec<Entry>, data: Vec<u8>) -> Result<Self, String> {
        for (index, entry) in entries.iter().enumerate() {
            if entry.range(data.len()).is_none() {
                return Err(format!("the column `{}` does not lie in the file", entry.name));
            }
            if entries[..index].iter().any(|other| other.name == entry.name) {
                return Err(format!("the column `{}` is there twice", entry.name));
            }
        }
        let taken = vec![false; entries.len()];
        Ok(Self { loading: true, entries, taken, data, ..Self::default() })
    }

    /// Is it being loaded?
    pub fn is_loading(&self) -> bool {
        self.loading
    }

    /// The columns.
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Their bytes.
    pub fn data(&self) -> &[u8] {
        &self.data
    }

    /// Names between here and the end of `inside` begin with `prefix/`.
    pub fn within(&mut self, prefix: &str, inside: impl FnOnce(&mut Self)) {
        let length = self.prefix.len();
        self.prefix.push_str(prefix);
        self.prefix.push('/');
        inside(self);
        self.prefix.truncate(length);
    }

    /// Columns that are named inside have these rows in this process; numbers are those of all. A
    /// process that loads columns gets the rows of all.
    pub fn rows(&mut self, rows: &[Row], inside: impl FnOnce(&mut Self)) {
        self.dealt = if self.loading { None } else { Dealt::new(rows, &self.ranks) };
        inside(self);
        self.dealt = None;
    }

    /// Notes that something does not fit; the first such note is the fault.
    pub fn refuse(&mut self, reason: impl Into<String>) {
        self.fault.get_or_insert(reason.into());
    }

    /// Does everything fit so far?
    pub fn is_sound(&self) -> bool {
        self.fault.is_none()
    }

    /// A column of records; one without rows is not there.
    pub fn records<T: Number, const W: usize>(&mut self, name: &str, values: &mut Vec<[T; W]>) {
        if !self.loading {
            return self.save(name, values);
        }
        values.clear();
        let Some(index) = self.find::<T>(name, W) else { return };
        let range = self.entries[index].range(self.data.len()).unwrap_or_default();
        let rows = self.data[range].chunks_exact(W * T::BYTES).map(|row| {
            let mut numbers = row.chunks_exact(T::BYTES).map(T::take);
            std::array::from_fn(|_| numbers.next().unwrap_or_default())
        });
        values.extend(rows);
    }

    fn save<T: Number, const W: usize>(&mut self, name: &str, values: &[[T; W]]) {
        match self.dealt.take() {
            Some(dealt) => {
                self.put_dealt(&dealt, name, values);
                self.dealt = Some(dealt);
            }
            None => self.put(name, values),
        }
    }

    fn put<T: Number, const W: usize>(&mut self, name: &str, values: &[[T; W]]) {
        if !values.is_empty() {
            let start = self.begin::<T>(name, W, values.len());
            self.data.resize(start + values.len() * W * T::BYTES, 0);
            let places = self.data[start..].chunks_exact_mut(T::BYTES);
            for (value, place) in values.as_flattened().iter().zip(places) {
                value.put(place);
            }
        }
    }

    fn put_dealt<T: Number, const W: usize>(
        &mut self,
        dealt: &Dealt,
        name: &str,
        values: &[[T; W]],
    ) {
        let width = W * T::BYTES;
        let mut own = Vec::new();
        if !values.is_empty() {
            own.resize(width * dealt.own.len(), 0);
            let rows = dealt.own.iter().flat_map(|place| values[*place]);
            for (value, place) in rows.zip(own.chunks_exact_mut(T::BYTES)) {
                value.put(place);
            }
        }
        let column = dealt.collect(&self.ranks, own, width);
        if !column.is_empty() {
            self.begin::<T>(name, W, column.len() / width);
            self.data.extend_from_slice(&column);
        }
    }

    /// A column of numbers; one without rows is not there.
    pub fn column<T: Number>(&mut self, name: &str, values: &mut Vec<T>) {
        if !self.loading {
            return self.save(name, values.as_chunks::<1>().0);
        }
        let mut records: Vec<[T; 1]> = Vec::new();
        self.records(name, &mut records);
        *values = records.into_iter().map(|[value]| value).collect();
    }

    /// Some numbers that must be there.
    pub fn numbers<T: Number, const W: usize>(&mut self, name: &str, values: &mut [T; W]) {
        let mut rows = vec![*values];
        let dealt = self.dealt.take();
        self.records(name, &mut rows);
        self.dealt = dealt;
        match rows[..] {
            [row] => *values = row,
            [] => self.refuse(format!("`{}{name}` is missing", self.prefix)),
            _ => self.refuse(format!("`{}{name}` has too many rows", self.prefix)),
        }
    }

    /// One number that must be there.
    pub fn number<T: Number>(&mut self, name: &str, value: &mut T) {
        let mut values = [*value];
        self.numbers(name, &mut values);
        [*value] = values;
    }

    /// A sum without rounding over all processes, word by word; the first one gets it back.
    pub fn sum(&mut self, name: &str, sum: &mut ExactSum) {
        let mut words = sum.words();
        if !self.loading
            && let Some(exchange) = self.ranks.exchange()
        {
            exchange.sum(&mut words);
            words = ExactSum::from_words(&words).words();
        }
        self.numbers(name, &mut words);
        if self.loading {
            let first = self.ranks.is_first();
            *sum = if first { ExactSum::from_words(&words) } else { ExactSum::default() };
        }
    }

    /// A count over all processes; the first one gets it back.
    pub fn count(&mut self, name: &str, count: &mut u64) {
        let [mut all] = match self.loading {
            true => [0],
            false => self.ranks.count([*count as usize]).map(|all| all as u64),
        };
        self.number(name, &mut all);
        if self.loading {
            *count = if self.ranks.is_first() { all } else { 0 };
        }
    }

    /// The largest number of all processes, which is none less than 0; all get it back.
    pub fn largest(&mut self, name: &str, number: &mut f64) {
        let mut all = if self.loading { 0.0 } else { self.ranks.largest([*number])[0] };
        self.number(name, &mut all);
        if self.loading {
            *number = all;
        }
    }

    /// Is it so in any process? All get it back.
    pub fn any(&mut self, name: &str, value: &mut bool) {
        let mut any = !self.loading && self.ranks.any(*value);
        self.flag(name, &mut any);
        if self.loading {
            *value = any;
        }
    }

    /// Three of them.
    pub fn vector(&mut self, name: &str, sum: &mut VectorSum) {
        for (part, axis) in sum.0.iter_mut().zip(["x", "y", "z"]) {
            self.sum(&format!("{name}/{axis}"), part);
        }
    }

    /// Yes or no.
    pub fn flag(&mut self, name: &str, value: &mut bool) {
        let mut number = u16::from(*value);
        self.number(name, &mut number);
        *value = number != 0;
    }

    /// A number that may not be there.
    pub fn option<T: Number>(&mut self, name: &str, value: &mut Option<T>) {
        let mut values: Vec<T> = value.iter().copied().collect();
        self.column(name, &mut values);
        *value = values.first().copied();
    }

    /// Loaded all and everything?
    ///
    /// # Errors
    /// The first thing that did not fit, or a column that nobody has asked for.
    pub fn finish(self) -> Result<(), String> {
        if let Some(fault) = self.fault {
            return Err(fault);
        }
        match self.taken.iter().position(|taken| !taken) {
            Some(left) => Err(format!("nothing here takes `{}`", self.entries[left].name)),
            None => Ok(()),
        }
    }

    fn begin<T: Number>(&mut self, name: &str, width: usize, rows: usize) -> usize {
        self.data.resize(self.data.len().next_multiple_of(8), 0);
        let (name, kind) = (format!("{}{name}", self.prefix), T::KIND.to_string());
        let offset = self.data.len();
        self.data.reserve(rows * width * T::BYTES);
        self.entries.push(Entry { name, kind, width, rows, offset });
        offset
    }

    /// The entry of a name; a wrong form is a fault.
    fn find<T: Number>(&mut self, name: &str, width: usize) -> Option<usize> {
        let name = format!("{}{name}", self.prefix);
        let index = self.entries.iter().position(|entry| entry.name == name)?;
        let entry = &self.entries[index];
        if entry.kind != T::KIND || entry.width != width {
            let form = format!("{} {} in a row", entry.width, entry.kind);
            self.refuse(format!("`{name}` has {form}, not {width} {}", T::KIND));
            return None;
        }
        self.taken[index] = true;
        Some(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Debug, Default, PartialEq)]
    struct State {
        places: Vec<[f64; 4]>,
        ids: Vec<u32>,
        total: [f64; 3],
        steps: u64,
        started: bool,
        last: Option<u64>,
    }

    fn keep(state: &mut State, checkpoint: &mut Checkpoint) {
        checkpoint.records("place", &mut state.places);
        checkpoint.within("part", |part| {
            part.column("id", &mut state.ids);
            part.numbers("total", &mut state.total);
        });
        checkpoint.number("steps", &mut state.steps);
        checkpoint.flag("started", &mut state.started);
        checkpoint.option("last", &mut state.last);
    }

    fn saved(state: &State) -> (Vec<Entry>, Vec<u8>) {
        let mut checkpoint = Checkpoint::saving(&Ranks::default());
        keep(&mut state.clone(), &mut checkpoint);
        (checkpoint.entries().to_vec(), checkpoint.data().to_vec())
    }

    fn state() -> State {
        State {
            places: vec![[0.1, -0.0, f64::NAN, 3.0], [f64::INFINITY, 1e-300, 0.0, 1.0]],
            ids: vec![7, 1, 3],
            total: [1.0, 2.0, 3.0],
            steps: u64::MAX,
            started: true,
            last: None,
        }
    }

    #[test]
    fn what_is_saved_comes_back_to_the_bit() {
        let (entries, data) = saved(&state());
        assert_eq!(entries[1].name, "part/id");
        assert!(entries.iter().all(|entry| entry.offset % 8 == 0));
        let mut checkpoint = Checkpoint::loading(entries.clone(), data.clone()).unwrap();
        let mut other = State { last: Some(3), ..State::default() };
        keep(&mut other, &mut checkpoint);
        checkpoint.finish().unwrap();
        assert_eq!(saved(&other), (entries, data));
        assert_eq!(other.last, None);
    }

    #[test]
    fn rows_are_saved_in_the_order_of_their_keys() {
        let (mut ids, mut total, mut records) = (vec![7u32, 1, 3, 9], 5u64, Vec::<[f64; 2]>::new());
        let row = |place: usize| Row { place, key: [0, [7, 1, 3, 9][place], 0] };
        let mut checkpoint = Checkpoint::saving(&Ranks::default());
        // The last one does not count here.
        checkpoint.rows(&[row(0), row(1), row(2)], |inside| {
            inside.column("id", &mut ids);
            inside.records("none", &mut records);
            inside.number("total", &mut total);
        });
        let (entries, data) = (checkpoint.entries().to_vec(), checkpoint.data().to_vec());
        let mut checkpoint = Checkpoint::loading(entries, data).unwrap();
        checkpoint.column("id", &mut ids);
        checkpoint.number("total", &mut total);
        checkpoint.finish().unwrap();
        assert_eq!((ids, total), (vec![1, 3, 7], 5));
    }

    #[test]
    fn what_is_missing_or_left_over_or_of_another_form_is_named() {
        let (entries, data) = saved(&state());
        let load = |entries: Vec<Entry>| {
            let mut checkpoint = Checkpoint::loading(entries, data.clone())?;
            keep(&mut State::default(), &mut checkpoint);
            checkpoint.finish()
        };
        let without = |name: &str| entries.iter().filter(|e| e.name != name).cloned().collect();
        assert_eq!(load(without("part/total")).unwrap_err(), "`part/total` is missing");
        let mut more = entries.clone();
        more.push(Entry { name: "new".to_string(), ..entries[0].clone() });
        assert_eq!(load(more).unwrap_err(), "nothing here takes `new`");
        let mut other = entries.clone();
        other[2].kind = "<u4".to_string();
        assert!(load(other).unwrap_err().starts_with("`part/total` has 3 <u4"));
        let mut far = entries.clone();
        far[0].rows = usize::MAX;
        assert_eq!(load(far).unwrap_err(), "the column `place` does not lie in the file");
    }
}
