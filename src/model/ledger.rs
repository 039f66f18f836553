//! Where the energy of a run goes.

use super::checkpoint::Checkpoint;
use crate::math::exact_sum::ExactSum;
use crate::parallel::Ranks;

/// Energies since the ledger was opened \[M L^2/T^2\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sums {
    /// Ek = sum m v^2/2 of the particles now.
    pub kinetic: f64,
    /// What the stress can give back.
    pub stored: f64,
    /// sum V q dep.
    pub plastic: f64,
    /// Work against artificial viscosity and against that of fluids.
    pub viscous: f64,
    /// Stored energy lost with stiffness.
    pub damage: f64,
    /// Work against friction of contacts.
    pub friction: f64,
    /// Work against damping fixes.
    pub damping: f64,
    /// The part of the plastic work that became heat.
    pub heat: f64,
    /// Work done by forces on nodes and particles.
    pub external: f64,
    /// Work done by prescribed velocities.
    pub boundary: f64,
    /// Kinetic energy lost on the way from particles to nodes and back.
    pub numerical: f64,
}

impl Sums {
    /// All of them: the kinetic energy, then those that have a book, in the order of the books.
    fn each_mut(&mut self) -> [&mut f64; 11] {
        [
            &mut self.kinetic,
            &mut self.stored,
            &mut self.plastic,
            &mut self.viscous,
            &mut self.damage,
            &mut self.friction,
            &mut self.damping,
            &mut self.heat,
            &mut self.external,
            &mut self.boundary,
            &mut self.numerical,
        ]
    }

    /// Everything that has become of the energy, less the work put in.
    fn balance(&self) -> f64 {
        let kept = self.kinetic + self.stored;
        let lost = self.plastic + self.viscous + self.damage + self.friction + self.damping;
        kept + lost + self.numerical - self.external - self.boundary
    }

    /// The largest of the terms, by size.
    fn largest(&self) -> f64 {
        let terms = [
            self.kinetic,
            self.stored,
            self.plastic,
            self.viscous,
            self.damage,
            self.friction,
            self.damping,
            self.numerical,
            self.external,
            self.boundary,
        ];
        terms.iter().fold(0.0, |largest, term| term.abs().max(largest))
    }
}

/// What nodes and particles of this process have done since the books were last settled: terms of the
/// [`Sums`] of the same names \[M L^2/T^2\].
#[derive(Clone, Debug, Default)]
pub struct Books {
    /// What the stress has stored.
    pub stored: ExactSum,
    /// Plastic work.
    pub plastic: ExactSum,
    /// Work against viscosity.
    pub viscous: ExactSum,
    /// Stored energy lost with stiffness.
    pub damage: ExactSum,
    /// Work against friction of contacts.
    pub friction: ExactSum,
    /// Work against damping fixes.
    pub damping: ExactSum,
    /// Plastic work that became heat.
    pub heat: ExactSum,
    /// Work done by forces.
    pub external: ExactSum,
    /// Work done by prescribed velocities.
    pub boundary: ExactSum,
    /// Kinetic energy lost on the way.
    pub numerical: ExactSum,
    /// Work of all nodal forces.
    pub nodal: ExactSum,
}

impl Books {
    /// All of them with their names; the last one has no sum.
    fn each_mut(&mut self) -> [(&'static str, &mut ExactSum); 11] {
        [
            ("stored", &mut self.stored),
            ("plastic", &mut self.plastic),
            ("viscous", &mut self.viscous),
            ("damage", &mut self.damage),
            ("friction", &mut self.friction),
            ("damping", &mut self.damping),
            ("heat", &mut self.heat),
            ("external", &mut self.external),
            ("boundary", &mut self.boundary),
            ("numerical", &mut self.numerical),
            ("nodal", &mut self.nodal),
        ]
    }
}

/// What the particles of a tile have done in a step \[M L^2/T^2\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Work of the stress V0 (J sigma : D) dt.
    pub work: f64,
    /// V q dep.
    pub plastic: f64,
    /// Work against viscosity.
    pub viscous: f64,
    /// Stored energy lost with stiffness.
    pub damage: f64,
    /// Plastic work that became heat.
    pub heat: f64,
}

impl Share {
    /// Adds what others have done.
    #[inline]
    pub fn add(&mut self, other: &Share) {
        self.work += other.work;
        self.plastic += other.plastic;
        self.viscous += other.viscous;
        self.damage += other.damage;
        self.heat += other.heat;
    }
}

/// What a node has seen in the step under way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Notes {
    /// Momentum after P2G \[M L/T\].
    pub momentum: [f64; 3],
    /// Internal force \[M L/T^2\].
    pub internal: [f64; 3],
    /// External force.
    pub external: [f64; 3],
    /// Force of damping fixes.
    pub damping: [f64; 3],
    /// Force of other bodies in contact.
    pub contact: [f64; 3],
    /// Change of the velocity that the particles will see, v* - v \[L/T\].
    pub change: [f64; 3],
    /// The mean of v and v* where they are prescribed.
    pub prescribed: [Option<f64>; 3],
}

/// The energy ledger: empty unless the scene has a compute that reads it.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    /// Is it kept?
    pub open: bool,
    /// Energies since it was opened.
    pub sums: Sums,
    /// What is not yet in them.
    pub books: Books,
    /// Balance at its start.
    start: f64,
    /// Largest term so far.
    largest: f64,
    /// Stored energy of the laws at the end of the last run.
    pub strain: f64,
    /// Residual in the middle of the last change of the stresses.
    residual: f64,
    /// What the nodes of the step under way have seen.
    pub nodes: Vec<Notes>,
    /// What the particles of each tile have done in the step.
    pub shares: Vec<Share>,
    /// Kinetic energy of the particles of each tile.
    pub kinetic: Vec<f64>,
}

impl Ledger {
    /// Opens the ledger with the energies of the present state, or, if it is open, books what has
    /// changed since the last run as work from outside.
    pub fn begin(&mut self, kinetic: f64, strain: f64, nodes: usize, tiles: usize) {
        if self.open {
            self.sums.external += kinetic - self.sums.kinetic + strain - self.strain;
            self.sums.stored += strain - self.strain;
            self.sums.kinetic = kinetic;
        } else {
            self.open = true;
            self.sums = Sums { kinetic, stored: strain, ..Sums::default() };
            self.books = Books::default();
            self.start = self.sums.balance();
            self.largest = self.sums.largest();
            self.residual = 0.0;
        }
        self.strain = strain;
        self.fit(nodes, tiles);
    }

    /// Puts it into a checkpoint, or takes it from there.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.flag("open", &mut self.open);
        let Self { start, largest, strain, residual, .. } = self;
        let mut numbers = [*start, *largest, *strain, *residual];
        checkpoint.numbers("numbers", &mut numbers);
        [*start, *largest, *strain, *residual] = numbers;
        for (name, sum) in self.books.each_mut() {
            checkpoint.sum(&format!("books/{name}"), sum);
        }
        let terms = self.sums.each_mut();
        let mut values = terms.each_ref().map(|term| **term);
        checkpoint.numbers("sums", &mut values);
        for (term, value) in terms.into_iter().zip(values) {
            *term = value;
        }
    }

    /// Closes the ledger and gives its memory back.
    pub fn close(&mut self) {
        *self = Self::default();
    }

    /// Makes room for so many nodes and tiles; what particles have done is cleared.
    pub fn fit(&mut self, nodes: usize, tiles: usize) {
        self.fit_tiles(tiles);
        self.nodes.resize(nodes, Notes::default());
    }

    /// Shares for the tiles that a sort has left; `usf` strains before the next step is noted.
    pub fn fit_tiles(&mut self, tiles: usize) {
        self.shares.clear();
        self.shares.resize(tiles, Share::default());
    }

    /// Notes the force of a damping fix on a node.
    pub fn add_damping(&mut self, node: usize, force: [f64; 3]) {
        if let Some(notes) = self.nodes.get_mut(node) {
            for (sum, force) in notes.damping.iter_mut().zip(force) {
                *sum += force;
            }
        }
    }

    /// Books what the particles have done in a step.
    ///
    /// Velocities belong to the middle of the time in which they strain the particles. So the
    /// residual is taken there too: between the balances before and after.
    pub fn collect(&mut self, ranks: &Ranks) {
        self.settle(ranks);
        let before = self.sums.balance();
        let books = &mut self.books;
        for share in &self.shares {
            let lost = share.plastic + share.viscous + share.damage;
            books.stored.add(share.work - lost);
            books.plastic.add(share.plastic);
            books.viscous.add(share.viscous);
            books.damage.add(share.damage);
            books.heat.add(share.heat);
        }
        self.settle(ranks);
        self.residual = 0.5 * (before + self.sums.balance()) - self.start;
        self.largest = self.largest.max(self.sums.largest());
    }

    /// Adds what stands in the books of all processes to the sums; gives the work of the nodal
    /// forces among it.
    pub fn settle(&mut self, ranks: &Ranks) -> f64 {
        let mut books = std::mem::take(&mut self.books);
        let [totals @ .., work] = ranks.totals(books.each_mut().map(|(_, sum)| &*sum));
        let [_, sums @ ..] = self.sums.each_mut();
        for (sum, total) in sums.into_iter().zip(totals) {
            *sum += total;
        }
        work
    }

    /// What is left over: all energies and losses, less the work put in, less those of the start.
    pub fn residual(&self) -> f64 {
        self.residual
    }

    /// The residual over the largest term so far.
    pub fn error(&self) -> f64 {
        if self.largest > 0.0 { self.residual / self.largest } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_neither_kept_nor_lost_is_the_residual() {
        let mut ledger = Ledger::default();
        let alone = &Ranks::default();
        ledger.begin(3.0, 1.0, 2, 1);
        assert_eq!((ledger.residual(), ledger.error()), (0.0, 0.0));
        ledger.shares[0] = Share { work: 2.0, plastic: 0.5, ..Share::default() };
        ledger.collect(alone);
        // Half way through the step one of the two has been done.
        assert_eq!((ledger.sums.stored, ledger.residual()), (2.5, 1.0));
        ledger.sums.kinetic -= 1.0;
        ledger.sums.external += 0.5;
        ledger.fit(2, 1);
        ledger.collect(alone);
        assert_eq!((ledger.residual(), ledger.error()), (0.5, 0.5 / 3.0));
        // A jump between two runs is work from outside and leaves the residual alone.
        ledger.begin(7.0, 1.25, 2, 1);
        ledger.collect(alone);
        assert_eq!((ledger.sums.external, ledger.residual()), (5.75, 0.5));
        ledger.add_damping(5, [1.0; 3]);
        ledger.add_damping(1, [1.0; 3]);
        assert_eq!([ledger.nodes[0].damping, ledger.nodes[1].damping], [[0.0; 3], [1.0; 3]]);
    }
}
