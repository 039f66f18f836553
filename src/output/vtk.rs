//! Files of ParaView: points (`.vtp`), regular lattices (`.vti`) and the index of a series (`.pvd`).
//!
//! XML that says what there is, then all numbers in one block, little endian, each array behind the
//! number of its bytes (appended raw, header UInt64).

use super::joint::Joint;
use super::lammps::Table;
use super::{SOFTWARE, number};
use std::fmt::Write as _;

/// Scalar columns that become one array, in VTK's order of components.
const TUPLES: [(&str, &[&str]); 10] = [
    ("v", &["vx", "vy", "vz"]),
    ("x0", &["x0", "y0", "z0"]),
    ("b", &["bx", "by", "bz"]),
    ("s", &["s11", "s22", "s33", "s12", "s23", "s13"]),
    ("e", &["e11", "e22", "e33", "e12", "e23", "e13"]),
    ("F", &["F11", "F12", "F13", "F21", "F22", "F23", "F31", "F32", "F33"]),
    (
        "StressTensor",
        &[
            "StressTensor.XX",
            "StressTensor.YY",
            "StressTensor.ZZ",
            "StressTensor.XY",
            "StressTensor.YZ",
            "StressTensor.XZ",
        ],
    ),
    (
        "DeformationGradient",
        &[
            "DeformationGradient.XX",
            "DeformationGradient.XY",
            "DeformationGradient.XZ",
            "DeformationGradient.YX",
            "DeformationGradient.YY",
            "DeformationGradient.YZ",
            "DeformationGradient.ZX",
            "DeformationGradient.ZY",
            "DeformationGradient.ZZ",
        ],
    ),
    ("Orientation", &["Orientation.X", "Orientation.Y", "Orientation.Z", "Orientation.W"]),
    ("AsphericalShape", &["AsphericalShape.X", "AsphericalShape.Y", "AsphericalShape.Z"]),
];

/// Text in an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// The block of numbers, and the XML that describes its arrays.
struct Arrays<'a> {
    table: &'a Table<'a>,
    /// Bytes of each array in all processes, and those of this one.
    data: Vec<(u64, Vec<u8>)>,
    /// Where the next array begins.
    offset: u64,
}

impl Arrays<'_> {
    /// Adds an array of `width` numbers of 8 bytes for each row; gives its element.
    fn add(&mut self, attributes: &str, width: usize, put: impl FnOnce(&mut Vec<u8>)) -> String {
        let (rows, offset) = (self.table.order.len(), self.offset);
        let mut own = Vec::with_capacity(8 * width * rows);
        put(&mut own);
        debug_assert_eq!(own.len(), 8 * width * rows);
        let bytes = (8 * width * self.table.part.all) as u64;
        self.data.push((bytes, own));
        self.offset += 8 + bytes;
        format!("<DataArray {attributes} format=\"appended\" offset=\"{offset}\"/>\n")
    }

    /// An array of whole numbers.
    fn integers(&mut self, name: &str, values: impl Iterator<Item = i64>) -> String {
        self.add(&format!("type=\"Int64\" Name=\"{name}\""), 1, |data| {
            values.for_each(|value| data.extend(value.to_le_bytes()));
        })
    }

    /// An array of the columns of a table; several are its components.
    fn columns(&mut self, name: &str, columns: &[usize]) -> String {
        let table = self.table;
        let mut attributes = format!(
            "type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\"",
            escaped(name),
            columns.len()
        );
        if columns.len() > 1 {
            for (component, column) in columns.iter().enumerate() {
                let name = escaped(&table.names[*column]);
                let _ = write!(attributes, " ComponentName{component}=\"{name}\"");
            }
        }
        self.add(&attributes, columns.len(), |data| {
            for place in table.order {
                for column in columns {
                    data.extend(table.values[*column].at(*place as usize).to_le_bytes());
                }
            }
        })
    }
}

/// Which columns make which array: tuples that are complete, all others alone, none twice. Places
/// are the points themselves.
fn arrays_of(names: &[String]) -> Vec<(String, Vec<usize>)> {
    let find = |name: &str| names.iter().position(|known| known == name);
    let mut arrays: Vec<(String, Vec<usize>)> = Vec::new();
    for (index, name) in names.iter().enumerate() {
        if ["x", "y", "z"].contains(&name.as_str()) {
            continue;
        }
        let whole = TUPLES.iter().find_map(|(tuple, parts)| {
            let columns: Vec<usize> = parts.iter().filter_map(|part| find(part)).collect();
            let complete = columns.len() == parts.len() && parts.contains(&name.as_str());
            complete.then(|| (tuple.to_string(), columns))
        });
        let array = whole.unwrap_or_else(|| (name.clone(), vec![index]));
        if !arrays.iter().any(|(known, _)| *known == array.0) {
            arrays.push(array);
        }
    }
    arrays
}

/// Writes the snapshot as `.vti` if its rows are the nodes of a lattice, otherwise as `.vtp`.
pub fn write(table: &Table<'_>, file: &mut Joint<'_>) {
    let mut arrays = Arrays { table, data: Vec::new(), offset: 0 };
    let mut fields = String::from("<PointData>\n");
    let ids = table.order.iter().map(|place| (table.id)(*place as usize) as i64);
    fields += &arrays.integers("id", ids);
    let types = table.order.iter().map(|place| (table.kind)(*place as usize) as i64);
    fields += &arrays.integers("type", types);
    for (name, columns) in arrays_of(table.names) {
        fields += &arrays.columns(&name, &columns);
    }
    fields += "</PointData>\n";
    let (kind, attributes, piece, geometry) = match table.lattice {
        None => points(&mut arrays),
        Some(lattice) => {
            let extent = lattice.nodes.map(|count| format!("0 {}", count - 1)).join(" ");
            let origin = lattice.place([0; 3]).map(number::text).join(" ");
            let spacing = [lattice.spacing; 3].map(number::text).join(" ");
            let attributes =
                format!(" WholeExtent=\"{extent}\" Origin=\"{origin}\" Spacing=\"{spacing}\"");
            ("ImageData", attributes, format!("Extent=\"{extent}\""), String::new())
        }
    };
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<!-- {SOFTWARE} -->\n\
         <VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <{kind}{attributes}>\n<FieldData>\n"
    );
    for (name, value) in [("TimeValue", number::text(table.time)), ("step", table.step.to_string())]
    {
        let _ = writeln!(
            text,
            "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfTuples=\"1\" format=\"ascii\">{value}</DataArray>"
        );
    }
    let _ = write!(
        text,
        "</FieldData>\n<Piece {piece}>\n{fields}{geometry}</Piece>\n</{kind}>\n\
         <AppendedData encoding=\"raw\">\n_"
    );
    file.put(text.as_bytes());
    for (bytes, own) in arrays.data {
        file.put(&bytes.to_le_bytes());
        file.put_all(&[own]);
    }
    file.put(b"\n</AppendedData>\n</VTKFile>\n");
}

/// What `.vtp` has besides the arrays: places, and a vertex at each, which filters and surfaces need.
fn points(arrays: &mut Arrays<'_>) -> (&'static str, String, String, String) {
    let table = arrays.table;
    let attributes = "type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"";
    let places = arrays.add(attributes, 3, |data| {
        let point = |place: &u32| (table.point)(*place as usize);
        table.order.iter().flat_map(point).for_each(|x| data.extend(x.to_le_bytes()));
    });
    let first = table.part.before as i64;
    let rows = first..first + table.order.len() as i64;
    let vertices = arrays.integers("connectivity", rows.clone());
    let ends = arrays.integers("offsets", rows.map(|row| row + 1));
    let geometry = format!("<Points>\n{places}</Points>\n<Verts>\n{vertices}{ends}</Verts>\n");
    let count = table.part.all;
    let piece = format!("NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\"");
    ("PolyData", String::new(), piece, geometry)
}

/// The index of a series: time, part and file of each entry.
pub fn index(entries: &[(f64, u64, String)]) -> Vec<u8> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, part, name) in entries {
        let (time, name) = (number::text(*time), escaped(name));
        let _ = writeln!(text, "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{name}\"/>");
    }
    text.push_str("</Collection>\n</VTKFile>\n");
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::super::lammps::tests::{bytes, two_rows};
    use super::*;

    #[test]
    fn components_come_together_and_nothing_comes_twice() {
        let names = ["x", "vx", "s11", "vz", "seq", "vy", "seq", "s22"].map(str::to_string);
        let expected = [
            ("v".to_string(), vec![1, 5, 3]),
            ("s11".to_string(), vec![2]),
            ("seq".to_string(), vec![4]),
            ("s22".to_string(), vec![7]),
        ];
        assert_eq!(arrays_of(&names), expected);
        let complete = TUPLES.iter().flat_map(|(_, parts)| parts.iter().map(|p| p.to_string()));
        let names: Vec<String> = complete.collect();
        assert_eq!(arrays_of(&names).len(), TUPLES.len());
    }

    #[test]
    fn every_array_lies_where_its_offset_says() {
        let names = ["vx", "vy", "T"].map(str::to_string).to_vec();
        let bytes = bytes(|file| write(&two_rows(&names, &[1, 0]), file));
        let mark = b"encoding=\"raw\">\n_";
        let start = bytes.windows(mark.len()).position(|part| part == mark).unwrap() + mark.len();
        let text = String::from_utf8_lossy(&bytes[..start]).into_owned();
        let offset = |name: &str| {
            let element = text.split("<DataArray").find(|part| part.contains(name)).unwrap();
            let digits = element.split("offset=\"").nth(1).unwrap().split('"').next().unwrap();
            start + digits.parse::<usize>().unwrap()
        };
        let word = |at: usize| bytes[at..at + 8].try_into().unwrap();
        assert_eq!(u64::from_le_bytes(word(offset("\"vy\""))), 16);
        assert_eq!(f64::from_le_bytes(word(offset("\"vy\"") + 8)), -0.4025);
        assert_eq!(f64::from_le_bytes(word(offset("\"Points\"") + 8)), -0.4525);
        assert_eq!(i64::from_le_bytes(word(offset("\"offsets\"") + 16)), 2);
        assert!(text.contains(">0.05</DataArray>"));
    }
}
