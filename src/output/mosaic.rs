//! Pictures that several processes draw together, each the balls it has.
//!
//! Every process draws its balls into pixels with depth and sends those pixels, and the balls that
//! are seen in them, to the first one, which keeps the nearest ball of each pixel; of those equally
//! near that with the least id, as one process would that draws all balls by id.

use super::canvas::Colour;
use super::raster::{Ball, Drawing};
use crate::parallel::Ranks;

/// Words of a ball in a letter: id, centre, radius, colour.
const BALL: usize = 6;

/// Bytes of a pixel in a letter: pixel, depth, ball, process.
const PIXEL: usize = 16;

/// Draws the balls of all processes, which are given with their ids and stand by id; gives the drawing
/// and the balls in it, in the first process.
pub fn draw(
    ranks: &Ranks,
    [width, height]: [usize; 2],
    ids: &[u32],
    balls: Vec<Ball>,
) -> (Drawing, Vec<Ball>) {
    let mut drawing = Drawing::new(width, height);
    drawing.balls(&balls);
    let Some(exchange) = ranks.exchange() else { return (drawing, balls) };
    let [seen, pixels] = letters(&drawing, ids, &balls, exchange.rank());
    let (balls, places) = join_balls(&exchange.gather(&seen));
    let mut whole = Drawing::new(width, height);
    exchange.collect(&[pixels], &mut |piece| join_pixels(&mut whole, &places, piece));
    (whole, balls)
}

/// What a process sends of its drawing: the balls that are seen, and the pixels.
fn letters(drawing: &Drawing, ids: &[u32], balls: &[Ball], rank: usize) -> [Vec<u8>; 2] {
    let mut numbers = vec![None; balls.len()];
    let [mut seen, mut pixels] = [Vec::new(), Vec::new()];
    let mut count = 0u32;
    for (pixel, depth, ball) in drawing.drawn() {
        let number = *numbers[ball].get_or_insert_with(|| {
            let Ball { centre: [x, y, z], radius, colour: Colour(r, g, b) } = balls[ball];
            let colour = u64::from_le_bytes([r, g, b, 0, 0, 0, 0, 0]);
            let [x, y, z, radius] = [x, y, z, radius].map(f64::to_bits);
            for word in [u64::from(ids[ball]), x, y, z, radius, colour] {
                seen.extend_from_slice(&word.to_le_bytes());
            }
            count += 1;
            count - 1
        });
        for word in [pixel as u32, depth.to_bits(), number, rank as u32] {
            pixels.extend_from_slice(&word.to_le_bytes());
        }
    }
    [seen, pixels]
}

/// The balls of all letters by id, and where those of each letter are.
fn join_balls(letters: &[Vec<u8>]) -> (Vec<Ball>, Vec<Vec<u32>>) {
    let word = |bytes: &[u8; 8]| u64::from_le_bytes(*bytes);
    let mut all = Vec::new();
    let mut places = Vec::new();
    for (rank, letter) in letters.iter().enumerate() {
        let words: Vec<u64> = letter.as_chunks::<8>().0.iter().map(word).collect();
        let balls = words.as_chunks::<BALL>().0;
        places.push(vec![0; balls.len()]);
        for (number, [id, x, y, z, radius, colour]) in balls.iter().enumerate() {
            let [x, y, z, radius] = [x, y, z, radius].map(|bits| f64::from_bits(*bits));
            let [r, g, b, ..] = colour.to_le_bytes();
            let ball = Ball { centre: [x, y, z], radius, colour: Colour(r, g, b) };
            all.push((*id, rank, number, ball));
        }
    }
    all.sort_unstable_by_key(|(id, ..)| *id);
    for (place, (_, rank, number, _)) in all.iter().enumerate() {
        places[*rank][*number] = place as u32;
    }
    (all.into_iter().map(|(.., ball)| ball).collect(), places)
}

/// Puts pixels of a letter into the whole drawing.
fn join_pixels(whole: &mut Drawing, places: &[Vec<u32>], letter: &[u8]) {
    for pixel in letter.as_chunks::<PIXEL>().0 {
        let mut words = pixel.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes));
        let [pixel, depth, number, rank] = std::array::from_fn(|_| words.next().unwrap_or(0));
        let ball = places[rank as usize][number as usize];
        whole.join(pixel as usize, f32::from_bits(depth), ball);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_make_the_picture_of_one_process() {
        // Balls in rows that hide each other, some of them equally near.
        let ball = |id: u32| {
            let x = f64::from(id * 7 % 40);
            let centre = [x, f64::from(id * 3 % 25), f64::from(id * 5 % 4)];
            Ball { centre, radius: 2.0 + f64::from(id % 3), colour: Colour(id as u8, 7, 9) }
        };
        let balls: Vec<Ball> = (0..200).map(ball).collect();
        let mut one = Drawing::new(40, 25);
        one.balls(&balls);
        let of = |rank: u32| (0..200).filter(|id| id * 13 % 3 == rank).collect::<Vec<u32>>();
        let parts: Vec<[Vec<u8>; 2]> = (0..3)
            .map(|rank| {
                let ids = of(rank);
                let own: Vec<Ball> = ids.iter().map(|id| ball(*id)).collect();
                let mut drawing = Drawing::new(40, 25);
                drawing.balls(&own);
                letters(&drawing, &ids, &own, rank as usize)
            })
            .collect();
        let seen: Vec<Vec<u8>> = parts.iter().map(|[seen, _]| seen.clone()).collect();
        let (found, places) = join_balls(&seen);
        assert!(found.len() < balls.len(), "hidden balls are not sent");
        let mut whole = Drawing::new(40, 25);
        parts.iter().for_each(|[_, pixels]| join_pixels(&mut whole, &places, pixels));
        for lit in [false, true] {
            assert_eq!(whole.finish(&found, lit), one.finish(&balls, lit));
        }
    }
}
