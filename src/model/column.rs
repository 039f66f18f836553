//! The one table of particle columns.
//!
//! A quantity is declared here once; growth, removal, sorting, dump names and units follow.

/// A scalar column of the particle table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(usize)]
pub enum Column {
    /// Reference position.
    X0,
    Y0,
    Z0,
    /// Cauchy stress.
    S11,
    S22,
    S33,
    S12,
    S13,
    S23,
    /// Deformation gradient.
    F11,
    F12,
    F13,
    F21,
    F22,
    F23,
    F31,
    F32,
    F33,
    /// det F.
    J,
    /// External force of the step.
    Bx,
    By,
    Bz,
    /// Equivalent plastic strain.
    PlasticStrain,
    /// Rate of the equivalent plastic strain.
    PlasticStrainRate,
    /// Damage D, from 0 to 1.
    Damage,
    /// What damage needs before it begins: it does at 1.
    DamageInitiation,
    /// Temperature.
    Temperature,
    /// Artificial part of the pressure, kept for the energy ledger.
    ViscousPressure,
    /// Internal energy per reference volume.
    InternalEnergy,
}

/// Number of columns in the table.
pub const COLUMNS: usize = Column::InternalEnergy as usize + 1;

/// What the table says about a column.
pub struct ColumnInfo {
    /// Name in dumps.
    pub name: &'static str,
    /// Dimension: L, T, M, K, P = M/(L T^2), 1.
    pub unit: &'static str,
    /// Value of a new particle.
    pub initial: f64,
}

const fn row(name: &'static str, unit: &'static str) -> ColumnInfo {
    ColumnInfo { name, unit, initial: 0.0 }
}

const fn one(name: &'static str) -> ColumnInfo {
    ColumnInfo { name, unit: "1", initial: 1.0 }
}

/// The table, in the order of [`Column`].
pub const TABLE: [ColumnInfo; COLUMNS] = [
    row("x0", "L"),
    row("y0", "L"),
    row("z0", "L"),
    row("s11", "P"),
    row("s22", "P"),
    row("s33", "P"),
    row("s12", "P"),
    row("s13", "P"),
    row("s23", "P"),
    one("F11"),
    row("F12", "1"),
    row("F13", "1"),
    row("F21", "1"),
    one("F22"),
    row("F23", "1"),
    row("F31", "1"),
    row("F32", "1"),
    one("F33"),
    one("J"),
    row("bx", "M L/T^2"),
    row("by", "M L/T^2"),
    row("bz", "M L/T^2"),
    row("ep", "1"),
    row("epdot", "1/T"),
    row("damage", "1"),
    row("damage_init", "1"),
    row("T", "K"),
    row("viscous_pressure", "P"),
    row("ienergy", "P"),
];

impl Column {
    /// All columns, in order.
    pub const ALL: [Column; COLUMNS] = {
        use Column::*;
        [
            X0,
            Y0,
            Z0,
            S11,
            S22,
            S33,
            S12,
            S13,
            S23,
            F11,
            F12,
            F13,
            F21,
            F22,
            F23,
            F31,
            F32,
            F33,
            J,
            Bx,
            By,
            Bz,
            PlasticStrain,
            PlasticStrainRate,
            Damage,
            DamageInitiation,
            Temperature,
            ViscousPressure,
            InternalEnergy,
        ]
    };

    /// The column's row of the table.
    pub fn info(self) -> &'static ColumnInfo {
        &TABLE[self as usize]
    }

    /// The column a dump field names.
    pub fn named(name: &str) -> Option<Column> {
        Column::ALL.into_iter().find(|column| column.info().name == name)
    }

    /// Stress components that exist in `dimension` (plane strain keeps the out-of-plane normal).
    pub fn stress(dimension: usize) -> &'static [Column] {
        use Column::*;
        match dimension {
            1 => &[S11, S22, S33],
            2 => &[S11, S22, S33, S12],
            _ => &[S11, S22, S33, S12, S13, S23],
        }
    }

    /// Components of the deformation gradient that change in `dimension`.
    pub fn deformation(dimension: usize) -> &'static [Column] {
        use Column::*;
        match dimension {
            1 => &[F11],
            2 => &[F11, F12, F21, F22],
            _ => &[F11, F12, F13, F21, F22, F23, F31, F32, F33],
        }
    }

    /// The same where x is a radius: the hoop stretch is F33.
    pub const ROUND_DEFORMATION: &[Column] = {
        use Column::*;
        &[F11, F12, F21, F22, F33]
    };
}

/// A set of columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ColumnSet(u64);

impl ColumnSet {
    /// Adds a column.
    pub fn insert(&mut self, column: Column) {
        self.0 |= 1 << column as usize;
    }

    /// Adds several columns.
    pub fn extend(&mut self, columns: &[Column]) {
        for column in columns {
            self.insert(*column);
        }
    }

    /// Is the column in the set?
    pub fn contains(self, column: Column) -> bool {
        self.0 >> column as usize & 1 == 1
    }

    /// The columns of either set.
    pub fn union(self, other: ColumnSet) -> ColumnSet {
        ColumnSet(self.0 | other.0)
    }

    /// The columns of this set that are not in the other.
    pub fn without(self, other: ColumnSet) -> ColumnSet {
        ColumnSet(self.0 & !other.0)
    }

    /// The columns of both sets.
    pub fn common(self, other: ColumnSet) -> ColumnSet {
        ColumnSet(self.0 & other.0)
    }

    /// The columns of the set, in the order of the table.
    pub fn iter(self) -> impl Iterator<Item = Column> {
        let mut left = self.0;
        std::iter::from_fn(move || {
            let column = Column::ALL.get(left.trailing_zeros() as usize)?;
            left &= left - 1;
            Some(*column)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_columns() {
        for (index, column) in Column::ALL.into_iter().enumerate() {
            assert_eq!(column as usize, index);
            assert_eq!(Column::named(column.info().name), Some(column));
        }
    }
}
