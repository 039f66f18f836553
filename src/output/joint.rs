//! A file that all processes write together, through the first one.

use super::file::Writer;
use crate::fault::Fault;
use crate::parallel::Ranks;

/// Such a file. All processes make the same calls; the others have no file, and a file that cannot
/// be written takes what still comes and drops it.
pub struct Joint<'a> {
    ranks: &'a Ranks,
    file: Result<Option<Writer>, Fault>,
}

impl<'a> Joint<'a> {
    /// What the first process opens.
    pub fn new(ranks: &'a Ranks, open: impl FnOnce() -> Result<Writer, Fault>) -> Self {
        let file = if ranks.is_first() { open().map(Some) } else { Ok(None) };
        Self { ranks, file }
    }

    /// The processes.
    pub fn ranks(&self) -> &'a Ranks {
        self.ranks
    }

    /// Adds bytes of the first process.
    pub fn put(&mut self, bytes: &[u8]) {
        if let Ok(Some(file)) = &mut self.file
            && let Err(fault) = file.put(bytes)
        {
            self.file = Err(fault);
        }
    }

    /// Adds the parts of all processes, in the order of ranks.
    pub fn put_all(&mut self, parts: &[Vec<u8>]) {
        match self.ranks.exchange() {
            Some(exchange) => exchange.collect(parts, &mut |piece| self.put(piece)),
            None => parts.iter().for_each(|part| self.put(part)),
        }
    }

    /// The file is complete; gives its length, 0 where there is no file.
    ///
    /// # Errors
    /// In the first process, the path and the system's reason.
    pub fn finish(self) -> Result<u64, Fault> {
        self.file?.map_or(Ok(0), Writer::finish)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_stand_one_after_the_other_and_what_fails_is_told_at_the_end() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a");
        let ranks = Ranks::default();
        let mut file = Joint::new(&ranks, || Writer::whole(&path));
        file.put(b"one ");
        file.put_all(&[b"two ".to_vec(), Vec::new(), b"three".to_vec()]);
        assert_eq!(file.finish(), Ok(13));
        assert_eq!(std::fs::read(&path).unwrap(), b"one two three");
        let mut file = Joint::new(&ranks, || Writer::whole(&path.join("b")));
        file.put(b"lost");
        assert!(file.finish().is_err());
    }
}
