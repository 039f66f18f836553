//! Ways to run a scene: method, shape, transfer, scheme.

/// One of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Way {
    /// `ulmpm`, `tlmpm`, `ulcpdi`, `tlcpdi`.
    pub method: &'static str,
    /// The shape, or the domain of CPDI.
    pub shape: &'static str,
    /// The transfer, with alpha or the number of terms: `FLIP 1`, `XPIC 2`.
    pub transfer: &'static str,
    /// `musl`, `usl`, `usf`.
    pub scheme: &'static str,
}

/// Methods with their shapes or domains in two dimensions.
pub const SHAPES: [(&str, &str); 14] = [
    ("ulmpm", "linear"),
    ("ulmpm", "quadratic-spline"),
    ("ulmpm", "cubic-spline"),
    ("ulmpm", "gimp"),
    ("ulmpm", "cpgimp"),
    ("ulcpdi", "R4"),
    ("ulcpdi", "Q4"),
    ("tlmpm", "linear"),
    ("tlmpm", "quadratic-spline"),
    ("tlmpm", "cubic-spline"),
    ("tlmpm", "Bernstein-quadratic"),
    ("tlmpm", "gimp"),
    ("tlcpdi", "R4"),
    ("tlcpdi", "Q4"),
];

/// Transfers.
pub const TRANSFERS: [&str; 9] =
    ["PIC", "FLIP 1", "FLIP 0.99", "APIC", "AFLIP 0.99", "ASFLIP 0.99", "MLS", "XPIC 2", "XPIC 5"];

/// Schemes.
pub const SCHEMES: [&str; 3] = ["musl", "usl", "usf"];

/// All of them.
pub fn all() -> Vec<Way> {
    let mut ways = Vec::new();
    for (method, shape) in SHAPES {
        for transfer in TRANSFERS {
            for scheme in SCHEMES {
                let way = Way { method, shape, transfer, scheme };
                if way.is_legal() {
                    ways.push(way);
                }
            }
        }
    }
    ways
}

/// One way.
pub fn way(
    method: &'static str,
    shape: &'static str,
    transfer: &'static str,
    scheme: &'static str,
) -> Way {
    Way { method, shape, transfer, scheme }
}

impl Way {
    /// Does the language know it? MLS needs splines.
    fn is_legal(&self) -> bool {
        self.transfer != "MLS" || self.shape.ends_with("-spline")
    }

    /// Updated Lagrangian?
    pub fn is_updated(&self) -> bool {
        self.method.starts_with("ul")
    }

    /// Domains of CPDI?
    pub fn has_domains(&self) -> bool {
        self.method.ends_with("cpdi")
    }

    /// The kind of transfer, without numbers.
    pub fn kind(&self) -> &'static str {
        self.transfer.split(' ').next().unwrap_or("")
    }

    /// Does the transfer carry an affine field?
    pub fn is_affine(&self) -> bool {
        matches!(self.kind(), "APIC" | "AFLIP" | "ASFLIP" | "MLS")
    }

    /// The lines `method` and `scheme`.
    pub fn lines(&self) -> String {
        let (kind, number) = self.transfer.split_once(' ').unwrap_or((self.transfer, ""));
        let domains = self.has_domains();
        let mut words = vec![self.method, kind];
        if kind == "XPIC" {
            words.push(number);
        }
        words.push(if domains { "linear" } else { self.shape });
        if kind != "XPIC" && !number.is_empty() {
            words.push(number);
        }
        if domains {
            words.push(self.shape);
        }
        format!("method({})\nscheme({})\n", words.join(", "), self.scheme)
    }
}

impl std::fmt::Display for Way {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} {} {}", self.method, self.shape, self.transfer, self.scheme)
    }
}
