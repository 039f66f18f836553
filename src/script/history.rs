//! What has been performed so far: enough to build the same scene again.

/// A script, as far as it has been performed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Its name as the user gave it.
    pub name: String,
    /// Its whole text.
    pub text: String,
    /// `-var` of the command line.
    pub variables: Vec<(String, String)>,
    /// Number of statements performed, the one under way among them.
    pub performed: usize,
    /// Every number that its statements have taken from the simulation, in order.
    pub measured: Vec<f64>,
    /// Names and CRC-32 of the files it has read, in order.
    pub files: Vec<(String, u32)>,
}

/// All scripts that have led here; each but the first reads a restart file of the one before.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// The scripts, in order.
    pub parts: Vec<Part>,
}

impl History {
    /// A script begins.
    pub fn begin(&mut self, part: Part) {
        self.parts.push(part);
    }

    /// The script that is being performed.
    pub fn current(&mut self) -> Option<&mut Part> {
        self.parts.last_mut()
    }

    /// Notes a number taken from the simulation.
    pub fn note(&mut self, value: f64) {
        if let Some(part) = self.current() {
            part.measured.push(value);
        }
    }
}
