//! The particles of rigid solids, apart from the others.

/// Rigid particles: what the table of particles cannot keep during a step.
#[derive(Clone, Debug, Default)]
pub struct Rigid {
    /// Their places in the table, ascending.
    pub particles: Vec<u32>,
    /// Their velocities \[L/T\] while the others gather theirs.
    pub velocity: Vec<[f64; 4]>,
    /// Force \[M L/T^2\] of the material on each of them in the last step.
    pub reaction: Vec<[f64; 4]>,
    /// The nodes they carry have been found for the present places.
    pub flagged: bool,
}

impl Rigid {
    /// Lists the particles for which `rigid` is true.
    pub fn list(&mut self, count: usize, rigid: impl Fn(usize) -> bool) {
        let Rigid { particles, velocity, reaction, .. } = self;
        particles.clear();
        particles.extend((0..count).filter(|p| rigid(*p)).map(|p| p as u32));
        velocity.resize(particles.len(), [0.0; 4]);
        reaction.clear();
        reaction.resize(particles.len(), [0.0; 4]);
    }

    /// Force of the material on a particle; zero for one that is not rigid.
    pub fn reaction(&self, particle: usize) -> [f64; 4] {
        match self.particles.binary_search(&(particle as u32)) {
            Ok(place) => self.reaction[place],
            Err(_) => [0.0; 4],
        }
    }
}
