//! Pictures of particles coloured by a field (`picture`).

mod camera;

use super::canvas::{Anchor, Canvas, Colour, Mark, round_step};
use super::colours::{self, MAPS, Map};
use super::field::{self, Columns, Field};
use super::frame::{self, Frame, MARGIN};
use super::raster::Ball;
use super::{BuildDump, Dump, DumpTarget, Snapshot, file, mosaic, number};
use crate::fault::Fault;
use crate::fix::GroupKind;
use crate::model::checkpoint::Checkpoint;
use crate::model::group::GroupId;
use crate::plan::Plan;
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::style::Style;
use crate::world::World;
use camera::Camera;
use std::path::PathBuf;

/// The row of the table.
pub const STYLE: Style<BuildDump> = Style {
    name: "picture",
    usage: "field [, option, ...]",
    summary: "pictures of particles coloured by a field, in 3-D with light and depth",
    manual: "\
One picture for each snapshot in the format of the suffix, .png, .svg or .pdf; `*` in the name is the
step, without it the picture is overwritten. The field is `solid` (a colour for each solid) or any
field of a dump of particles: `dump(p, all, picture, 100, film.*.png, seq, range, 0, 2e8, numbered)`.
Options, in any order:
range, low, high     colours between these numbers, the same in all pictures; otherwise between the
                     smallest and the largest number of each picture
map, viridis         colours, or map, cool-warm: blue and red about a light middle
size, w, h           pixels (1000, 700)
limits, xlo, xhi [, ylo, yhi [, zlo, zhi]]   what is shown (the box); particles outside are not
view, azimuth, elevation   degrees about and above the horizon from where a 3-D scene is seen (-60, 20);
                     view, -90, 0 looks along y, view, -90, 90 along -z
up, x|y|z            the axis that points upwards (z)
dots, factor         radius of the dots, in halves of the edge of a cube of the particle's volume
                     (1.42: no gaps)
numbered             `*` is the number of the picture with five digits, 00000, 00001, ..., as programs
                     that make films want them: ffmpeg -framerate 25 -i film.%05d.png film.mp4
3-D is a parallel projection: the box with lines, balls that hide each other, axes and a scale.",
    build: Some(build),
};

/// Largest side of a picture.
const LARGEST: f64 = 16384.0;

/// Digits of numbered pictures.
const DIGITS: usize = 5;

/// Room for the bar of colours \[pixels\].
const BAR: f64 = 110.0;

/// What colours show.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shown {
    Solid,
    Field(Field),
}

struct Picture {
    pattern: String,
    group: GroupId,
    shown: Shown,
    name: String,
    range: Option<[f64; 2]>,
    map: Map,
    size: [u32; 2],
    limits: Option<[[f64; 3]; 2]>,
    camera: Camera,
    dots: f64,
    /// Number of the next picture, where `*` is not the step.
    number: Option<u64>,
}

fn build(args: &mut Args<'_>, target: &DumpTarget) -> Result<Box<dyn Dump>, Diagnostic> {
    if target.kind == GroupKind::Nodes {
        let message = "a picture shows `all` or a group of particles";
        return Err(Diagnostic::error(Code::GroupKind, target.group_span, message)
            .label("this is a group of nodes"));
    }
    target.need_suffix("a picture", &[".pdf", ".png", ".svg"])?;
    let name = args.word("a field, or `solid`")?;
    let shown = match name.text.as_str() {
        "solid" => Shown::Solid,
        _ => Shown::Field(field::find(&name)?),
    };
    let mut picture = Picture {
        pattern: target.file.clone(),
        group: target.group,
        shown,
        name: name.text,
        range: None,
        map: MAPS[0],
        size: [1000, 700],
        limits: None,
        camera: Camera::new(-60.0, 20.0),
        dots: 1.42,
        number: None,
    };
    while args.remaining() > 0 {
        picture.option(args, target)?;
    }
    Ok(Box::new(picture))
}

/// Two numbers, the second of which is the larger.
fn limits(args: &mut Args<'_>, what: [&str; 2]) -> Result<[f64; 2], Diagnostic> {
    let low = args.number(what[0])?;
    let high = args.number(what[1])?;
    if low.known && high.known && high.value <= low.value {
        return Err(args.out_of_range(&high, &format!("{} must be above {}", what[1], what[0])));
    }
    Ok([low.value, high.value])
}

impl Picture {
    fn option(&mut self, args: &mut Args<'_>, target: &DumpTarget) -> Result<(), Diagnostic> {
        const WORDS: [&str; 8] =
            ["range", "map", "size", "limits", "view", "up", "dots", "numbered"];
        let span = args.next_span();
        match WORDS[args.choice("an option of a picture", &WORDS)?] {
            "range" => {
                self.range = Some(limits(args, ["the lowest number", "the highest number"])?)
            }
            "map" => {
                let names = MAPS.map(|map| map.name);
                self.map = MAPS[args.choice("a map of colours", &names)?];
            }
            "size" => {
                let width = args.within("the width", 64.0, LARGEST)?.value;
                let height = args.within("the height", 64.0, LARGEST)?.value;
                self.size = [width as u32, height as u32];
            }
            "limits" => {
                let mut corners = [[0.0; 3]; 2];
                for (axis, letter) in ["x", "y", "z"].iter().enumerate().take(target.dimension) {
                    let what =
                        ["lower", "upper"].map(|side| format!("the {side} limit of {letter}"));
                    let [low, high] = limits(args, [&what[0], &what[1]])?;
                    (corners[0][axis], corners[1][axis]) = (low, high);
                }
                self.limits = Some(corners);
            }
            "view" => {
                let azimuth = args.within("the azimuth in degrees", -360.0, 360.0)?.value;
                let elevation = args.within("the elevation in degrees", -90.0, 90.0)?.value;
                let up = self.camera.up;
                self.camera = Camera::new(azimuth, elevation);
                self.camera.up = up;
            }
            "up" => {
                self.camera.up = args.choice("the axis that points upwards", &["x", "y", "z"])?
            }
            "dots" => self.dots = args.within("the size of the dots", 0.01, 100.0)?.value,
            _ if self.pattern.contains('*') => self.number = Some(0),
            _ => {
                let message = "numbered pictures need a `*` in the name of the file";
                return Err(Diagnostic::error(Code::NotCombined, span, message)
                    .label("there is one picture only"));
            }
        }
        Ok(())
    }
}

impl Dump for Picture {
    fn needs(&self, plan: &mut Plan, dimension: usize) {
        if let Shown::Field(field) = self.shown {
            field.needs(plan, dimension);
        }
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        if let Some(number) = &mut self.number {
            checkpoint.number("number", number);
        }
    }

    fn write(&mut self, snapshot: &Snapshot<'_>) -> Result<Vec<String>, Fault> {
        let number = match &mut self.number {
            Some(number) => {
                *number += 1;
                format!("{:0DIGITS$}", *number - 1)
            }
            None => snapshot.step.to_string(),
        };
        let path = PathBuf::from(self.pattern.replace('*', &number));
        let canvas = self.draw(snapshot);
        if snapshot.world.ranks.is_first() {
            file::write_whole(&path, &canvas.encode(&path))?;
        }
        Ok(vec![self.pattern.clone()])
    }
}

/// Particles of this process that are shown, by ascending id, with their colours.
struct Dots {
    ids: Vec<u32>,
    places: Vec<[f64; 3]>,
    radii: Vec<f64>,
    colours: Vec<Colour>,
    /// Limits of the numbers of all processes.
    range: [f64; 2],
}

impl Picture {
    /// The picture, in the first process.
    fn draw(&self, snapshot: &Snapshot<'_>) -> Canvas {
        let world = snapshot.world;
        let dots = self.dots(world);
        let mut canvas = Canvas::new(self.size[0], self.size[1]);
        let [width, height] = self.size.map(f64::from);
        let room = [width - BAR, height];
        match world.domain.dimension {
            3 => self.in_space(&mut canvas, world, &dots, room),
            _ => self.in_plane(&mut canvas, world, &dots, room),
        }
        let title = format!("t = {}", number::brief(snapshot.time));
        canvas.text([0.5 * room[0] as f32, 0.5 * MARGIN as f32], 16.0, Anchor::Middle, title);
        match self.shown {
            Shown::Field(_) => {
                let heights = [MARGIN + 20.0, height - MARGIN];
                self.map.bar(&mut canvas, &self.name, dots.range, room[0], heights);
            }
            Shown::Solid => legend(&mut canvas, world, room[0]),
        }
        canvas
    }

    fn dots(&self, world: &World) -> Dots {
        let particles = &world.particles;
        let inside = |p: &usize| match self.limits {
            Some([low, high]) => {
                let place = world.place(*p);
                (0..world.domain.dimension).all(|a| low[a] <= place[a] && place[a] <= high[a])
            }
            None => true,
        };
        let mut order: Vec<usize> =
            particles.of_group(&world.groups, self.group).filter(inside).collect();
        order.sort_unstable_by_key(|p| particles.id[*p]);
        let mut range = [0.0, 1.0];
        let colours = match self.shown {
            Shown::Solid => {
                order.iter().map(|p| Colour::of(particles.solid[*p] as usize)).collect()
            }
            Shown::Field(field) => {
                let values = Columns::new(world).values(field);
                let numbers = || order.iter().map(|p| values.at(*p));
                range = self.range.unwrap_or_else(|| {
                    let [low, high] = colours::limits(numbers());
                    let [low, high] = world.ranks.largest([-low, high]);
                    colours::range([-low, high])
                });
                let [low, high] = range;
                numbers().map(|value| self.map.of((value - low) / (high - low))).collect()
            }
        };
        let radius = |p: &usize| self.dots * field::radius(world, *p);
        Dots {
            ids: order.iter().map(|p| particles.id[*p]).collect(),
            places: order.iter().map(|p| world.place(*p)).collect(),
            radii: order.iter().map(radius).collect(),
            colours,
            range,
        }
    }

    /// Limits of x, y, z that are shown.
    fn shown_limits(&self, world: &World) -> [[f64; 3]; 2] {
        self.limits.unwrap_or([world.domain.lower, world.domain.upper])
    }

    fn in_plane(&self, canvas: &mut Canvas, world: &World, dots: &Dots, room: [f64; 2]) {
        let limits = match self.limits {
            Some([low, high]) if world.domain.dimension > 1 => [low, high].map(|c| [c[0], c[1]]),
            Some([low, high]) => {
                let [[_, below], [_, above]] = frame::limits(&world.domain);
                [[low[0], below], [high[0], above]]
            }
            None => frame::limits(&world.domain),
        };
        let frame = Frame::new(limits, room[0], room[1]);
        let corner = frame.place(frame.lower[0], frame.upper[1]).map(f64::round);
        let end = frame.place(frame.upper[0], frame.lower[1]).map(f64::round);
        let size = [0, 1].map(|axis| (end[axis] - corner[axis]).max(1.0) as usize);
        let balls = dots.balls(frame.scale, |place| {
            let [x, y] = frame.place(place[0], place[1]);
            [x - corner[0], y - corner[1], 0.0]
        });
        let (drawing, balls) = mosaic::draw(&world.ranks, size, &dots.ids, balls);
        let place = corner.map(|x| x as f32);
        canvas.marks.push(Mark::Image { place, raster: drawing.finish(&balls, false) });
        frame.axes(canvas);
    }

    fn in_space(&self, canvas: &mut Canvas, world: &World, dots: &Dots, room: [f64; 2]) {
        let [low, high] = self.shown_limits(world);
        let corners: [[f64; 3]; 8] = std::array::from_fn(|corner| {
            std::array::from_fn(|axis| [low, high][corner >> axis & 1][axis])
        });
        let seen = corners.map(|corner| self.camera.seen(corner));
        let bounds =
            |axis: usize| colours::range(colours::limits(seen.iter().map(|place| place[axis])));
        let ([left, right], [below, above]) = (bounds(0), bounds(1));
        let top = MARGIN;
        let frame = Frame::new([[left, below], [right, above]], room[0], room[1] - top);
        let pixel = |place: [f64; 3]| {
            let [x, y, depth] = self.camera.seen(place);
            let [x, y] = frame.place(x, y);
            [x, y, frame.scale * depth]
        };
        let balls = dots.balls(frame.scale, pixel);
        let size = [room[0].max(1.0) as usize, (room[1] - top).max(1.0) as usize];
        let (mut drawing, balls) = mosaic::draw(&world.ranks, size, &dots.ids, balls);
        for (a, b) in (0..8).flat_map(|a| (0..3).map(move |axis| (a, a | 1 << axis))) {
            if a != b {
                drawing.line(pixel(corners[a]), pixel(corners[b]));
            }
        }
        let raster = drawing.finish(&balls, true);
        canvas.marks.push(Mark::Image { place: [0.0, top as f32], raster });
        self.camera.axes(canvas, [45.0, room[1] as f32 - 45.0]);
        scale(canvas, frame.scale, room);
    }
}

impl Dots {
    fn balls(&self, scale: f64, pixel: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<Ball> {
        let ball = |((place, radius), colour): ((&[f64; 3], &f64), &Colour)| Ball {
            centre: pixel(*place),
            radius: radius * scale,
            colour: *colour,
        };
        self.places.iter().zip(&self.radii).zip(&self.colours).map(ball).collect()
    }
}

/// A line of a round length.
fn scale(canvas: &mut Canvas, pixels: f64, room: [f64; 2]) {
    let length = round_step(0.1 * room[0] / pixels, 1.0);
    let (x, y) = (room[0] as f32 - 20.0, room[1] as f32 - 25.0);
    let start = x - (length * pixels) as f32;
    let segments = vec![
        [[start, y], [x, y]],
        [[start, y - 4.0], [start, y + 4.0]],
        [[x, y - 4.0], [x, y + 4.0]],
    ];
    canvas.marks.push(Mark::Lines { segments, width: 1.5, colour: Colour::BLACK });
    canvas.text([0.5 * (start + x), y - 8.0], 12.0, Anchor::Middle, number::brief(length));
}

/// The names of the solids.
fn legend(canvas: &mut Canvas, world: &World, x: f64) {
    for (number, solid) in world.solids.iter().enumerate() {
        let y = MARGIN as f32 + 20.0 * (number as f32 + 1.0);
        let (centres, colour) = (vec![[x as f32 + 6.0, y - 4.0]], Colour::of(number));
        canvas.marks.push(Mark::Dots { centres, radius: 6.0, colour });
        canvas.text([x as f32 + 18.0, y], 12.0, Anchor::Start, solid.name.clone());
    }
}
