//! Meshes of Gmsh: `.msh` 2.x and 4.1, ASCII.

use super::element::{Family, KINDS, Kind, MOST_CORNERS, is_straight, measure};
use super::words::{Words, shown};
use super::{Corners, Mistake, Point, Points, place_in_words};
use std::collections::{HashMap, HashSet};

/// An element of the problem's dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Element {
    /// Its family.
    pub family: Family,
    /// Its corners; only as many as the family has count.
    pub corners: [u32; MOST_CORNERS],
    /// Its line in the file.
    pub line: usize,
}

/// Nodes and elements of one dimension.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Places of the nodes \[L\].
    pub nodes: Vec<[f64; 3]>,
    /// Elements of the problem's dimension.
    pub elements: Vec<Element>,
    /// What is odd about the file, in words.
    pub remarks: Vec<String>,
    dimension: usize,
}

/// Reads the elements of a dimension; those of lower ones are skipped.
///
/// # Errors
/// Another format, bytes that do not follow it, elements of a higher dimension, no element.
pub fn read(bytes: &[u8], dimension: usize) -> Result<Mesh, Mistake> {
    let mut reader = Reader {
        words: Words::new(bytes),
        mesh: Mesh { dimension, ..Mesh::default() },
        numbers: HashMap::new(),
        seen: HashSet::new(),
        curved: Vec::new(),
        repeated: Vec::new(),
    };
    reader.read()?;
    let Reader { mut mesh, curved, repeated, .. } = reader;
    if mesh.elements.is_empty() {
        let names = ["lines", "triangles or quadrangles", "tetrahedra or hexahedra"];
        let names = names[dimension - 1];
        return Err(Mistake::whole(format!(
            "there is no element of dimension {dimension} ({names})"
        )));
    }
    remark(&mut mesh.remarks, &repeated, "elements that stand there twice count once");
    remark(&mut mesh.remarks, &curved, "curved elements are taken with straight edges");
    Ok(mesh)
}

/// Adds what is odd about the elements in some lines, if there are any.
fn remark(remarks: &mut Vec<String>, lines: &[usize], what: &str) {
    if let Some(line) = lines.first() {
        let count = lines.len();
        remarks.push(format!("{what} ({count}, the first one in line {line})"));
    }
}

impl Mesh {
    /// Places of the corners of an element \[L\].
    pub fn corners(&self, element: &Element) -> Vec<[f64; 3]> {
        let corners = &element.corners[..element.family.corners()];
        corners.iter().map(|node| self.nodes[*node as usize]).collect()
    }

    /// One particle per element, at its centroid and with its volume.
    ///
    /// # Errors
    /// An element without volume.
    pub fn points(&self) -> Result<Points, Mistake> {
        let mut points = Points { remarks: self.remarks.clone(), ..Points::default() };
        points.lower[..self.dimension].fill(f64::INFINITY);
        points.upper[..self.dimension].fill(f64::NEG_INFINITY);
        let (mut turned, mut folded) = (Vec::new(), Vec::new());
        let (mut upright, mut depth) = (0, [f64::INFINITY, f64::NEG_INFINITY]);
        for element in &self.elements {
            let corners = self.corners(element);
            let found = measure(element.family, &corners);
            if found.volume == 0.0 || !found.volume.is_finite() {
                let first = place_in_words(corners[0]);
                let what = format!("the element at {first} has no volume");
                return Err(Mistake::at(element.line, what));
            }
            upright += usize::from(found.volume > 0.0);
            if found.volume < 0.0 {
                turned.push(element.line);
            }
            if found.folded {
                folded.push(element.line);
            }
            for corner in &corners {
                for axis in 0..self.dimension {
                    points.lower[axis] = points.lower[axis].min(corner[axis]);
                    points.upper[axis] = points.upper[axis].max(corner[axis]);
                }
                for across in &corner[self.dimension..] {
                    depth = [depth[0].min(*across), depth[1].max(*across)];
                }
            }
            let mut place = found.centroid;
            place[self.dimension..].fill(0.0);
            points.list.push(Point { place, volume: found.volume.abs() });
            points.corners.push(Corners::new(&corners));
        }
        let remarks = &mut points.remarks;
        if upright > 0 {
            remark(remarks, &turned, "elements turned over against the others count with |V|");
        }
        remark(remarks, &folded, "folded elements count with the volume of their map");
        if depth[1] > depth[0] {
            let what = "coordinates beyond the dimension of the problem differ; they are ignored";
            points.remarks.push(what.to_string());
        }
        Ok(points)
    }
}

/// A file half read.
struct Reader<'a> {
    words: Words<'a>,
    mesh: Mesh,
    /// Places of nodes by their numbers in the file.
    numbers: HashMap<u64, u32>,
    /// Corners of the elements so far, in rising order.
    seen: HashSet<[u32; MOST_CORNERS]>,
    curved: Vec<usize>,
    repeated: Vec<usize>,
}

impl Reader<'_> {
    fn read(&mut self) -> Result<(), Mistake> {
        let mut format = None;
        let mut elements = false;
        while let Some(section) = self.words.next() {
            let line = self.words.line;
            match (section, format) {
                (b"$MeshFormat", _) => format = Some(self.format()?),
                (b"$Nodes", Some(Format::Two)) => self.nodes_of_2()?,
                (b"$Nodes", Some(Format::Four)) => self.nodes_of_4()?,
                (b"$Elements", Some(Format::Two)) => self.elements_of_2()?,
                (b"$Elements", Some(Format::Four)) => self.elements_of_4()?,
                (_, None) => {
                    let found = shown(section);
                    let what = format!("no mesh of Gmsh: expected `$MeshFormat`, found `{found}`");
                    return Err(Mistake::at(line, what));
                }
                (section, _) if section.starts_with(b"$") => {
                    self.skip(section)?;
                    continue;
                }
                _ => {
                    let what = format!("expected a section, found `{}`", shown(section));
                    return Err(Mistake::at(line, what));
                }
            }
            elements |= section == b"$Elements";
            self.words.expect(&format!("$End{}", shown(&section[1..])))?;
        }
        match (format, elements) {
            (None, _) => Err(Mistake::whole("no mesh of Gmsh: there is no `$MeshFormat`")),
            (_, false) => Err(Mistake::whole("there is no section `$Elements`")),
            _ => Ok(()),
        }
    }

    /// Reads over a section that does not matter.
    fn skip(&mut self, section: &[u8]) -> Result<(), Mistake> {
        let line = self.words.line;
        while let Some(word) = self.words.next() {
            if word.starts_with(b"$End") && word[4..] == section[1..] {
                return Ok(());
            }
        }
        Err(Mistake::at(line, format!("the section `{}` has no end", shown(section))))
    }

    fn format(&mut self) -> Result<Format, Mistake> {
        let version = self.words.word("the version")?;
        let line = self.words.line;
        let version = String::from_utf8_lossy(version).into_owned();
        let binary = self.words.whole("0 for ASCII or 1 for binary")?;
        if binary != 0 {
            let what = "a binary mesh; `gmsh FILE -save -setnumber Mesh.Binary 0 -o NEW.msh` \
                        writes it as ASCII";
            return Err(Mistake::at(line, what));
        }
        self.words.whole("the size of numbers")?;
        match version.as_str() {
            "2" | "2.0" | "2.1" | "2.2" => Ok(Format::Two),
            "4.1" => Ok(Format::Four),
            _ => {
                let what = format!(
                    "version `{}`; 2.2 and 4.1 can be read: \
                     `gmsh FILE -save -format msh41 -o NEW.msh` writes it as 4.1",
                    shown(version.as_bytes())
                );
                Err(Mistake::at(line, what))
            }
        }
    }

    fn nodes_of_2(&mut self) -> Result<(), Mistake> {
        let count = self.words.whole("the number of nodes")?;
        self.reserve_nodes(count);
        for _ in 0..count {
            let number = self.words.whole("the number of a node")?;
            self.node(number)?;
        }
        Ok(())
    }

    /// Room for as many nodes as there can be in what is left of the file.
    fn reserve_nodes(&mut self, count: u64) {
        const SHORTEST: usize = 8;
        let most = self.words.remaining() / SHORTEST;
        let count = usize::try_from(count).unwrap_or(most).min(most);
        self.mesh.nodes.reserve(count);
        self.numbers.reserve(count);
    }

    fn node(&mut self, number: u64) -> Result<(), Mistake> {
        let mut place = [0.0; 3];
        for (coordinate, name) in place.iter_mut().zip(["x", "y", "z"]) {
            *coordinate = self.words.number(name)?;
        }
        let index = u32::try_from(self.mesh.nodes.len())
            .map_err(|_| Mistake::at(self.words.line, "more nodes than can be numbered"))?;
        if self.numbers.insert(number, index).is_some() {
            let what = format!("the node {number} stands there twice");
            return Err(Mistake::at(self.words.line, what));
        }
        self.mesh.nodes.push(place);
        Ok(())
    }

    fn nodes_of_4(&mut self) -> Result<(), Mistake> {
        let blocks = self.words.whole("the number of blocks")?;
        let count = self.words.whole("the number of nodes")?;
        self.reserve_nodes(count);
        self.words.whole("the smallest number of a node")?;
        self.words.whole("the largest number of a node")?;
        let mut numbers = Vec::new();
        for _ in 0..blocks {
            let dimension = self.words.whole("the dimension of an entity")?;
            self.words.number("the number of an entity")?;
            let parametric = self.words.whole("0 or 1 for parametric nodes")? != 0;
            let count = self.words.whole("the number of nodes of a block")?;
            numbers.clear();
            for _ in 0..count {
                numbers.push(self.words.whole("the number of a node")?);
            }
            for number in &numbers {
                self.node(*number)?;
                if parametric {
                    for _ in 0..dimension {
                        self.words.number("a parametric coordinate")?;
                    }
                }
            }
        }
        Ok(())
    }

    fn elements_of_2(&mut self) -> Result<(), Mistake> {
        let count = self.words.whole("the number of elements")?;
        for _ in 0..count {
            self.words.whole("the number of an element")?;
            let kind = self.kind()?;
            let tags = self.words.whole("the number of tags")?;
            for _ in 0..tags {
                self.words.number("a tag")?;
            }
            self.element(kind)?;
        }
        Ok(())
    }

    fn elements_of_4(&mut self) -> Result<(), Mistake> {
        let blocks = self.words.whole("the number of blocks")?;
        self.words.whole("the number of elements")?;
        self.words.whole("the smallest number of an element")?;
        self.words.whole("the largest number of an element")?;
        for _ in 0..blocks {
            self.words.whole("the dimension of an entity")?;
            self.words.number("the number of an entity")?;
            let kind = self.kind()?;
            let count = self.words.whole("the number of elements of a block")?;
            for _ in 0..count {
                self.words.whole("the number of an element")?;
                self.element(kind)?;
            }
        }
        Ok(())
    }

    fn kind(&mut self) -> Result<&'static Kind, Mistake> {
        let number = self.words.whole("the type of an element")?;
        let line = self.words.line;
        let kind = KINDS.iter().find(|kind| kind.number == number);
        let kind =
            kind.ok_or_else(|| Mistake::at(line, format!("unknown type of element {number}")))?;
        let (own, wanted) = (kind.family.dimension(), self.mesh.dimension);
        if own > wanted {
            let what = format!("an element of dimension {own} in a problem of dimension {wanted}");
            return Err(Mistake::at(line, what));
        }
        Ok(kind)
    }

    fn element(&mut self, kind: &Kind) -> Result<(), Mistake> {
        let counts = kind.family.dimension() == self.mesh.dimension;
        let corners = kind.family.corners();
        let mut element =
            Element { family: kind.family, corners: [0; MOST_CORNERS], line: self.words.line };
        let mut places = [[0.0; 3]; MOST_NODES];
        for k in 0..kind.nodes {
            let number = self.words.whole("the number of a node")?;
            if !counts {
                continue;
            }
            let node = *self.numbers.get(&number).ok_or_else(|| {
                Mistake::at(self.words.line, format!("there is no node {number}"))
            })?;
            if k < corners {
                element.corners[k] = node;
            }
            places[k] = self.mesh.nodes[node as usize];
        }
        if !counts {
            return Ok(());
        }
        let mut key = [u32::MAX; MOST_CORNERS];
        key[..corners].copy_from_slice(&element.corners[..corners]);
        key.sort_unstable();
        if !self.seen.insert(key) {
            self.repeated.push(element.line);
            return Ok(());
        }
        if !is_straight(kind, &places[..kind.nodes]) {
            self.curved.push(element.line);
        }
        self.mesh.elements.push(element);
        Ok(())
    }
}

/// Most nodes of an element.
const MOST_NODES: usize = 125;

/// Which of the two formats.
#[derive(Clone, Copy)]
enum Format {
    Two,
    Four,
}

#[cfg(test)]
mod tests;
