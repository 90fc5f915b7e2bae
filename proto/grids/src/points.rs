//! Points in named blocks, for output fields only.
//!
//! A block is a lattice, the product of three axes, or a list. Points of a lattice run along x
//! fastest, then along y, then along z; the blocks follow each other. The value of a field belongs
//! to its point, which has no area.

use serde::{Deserialize, Serialize};

/// Maximum number of points: a field on more would not fit into any machine.
const MOST: usize = 1 << 32;

/// Blocks of points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Points {
    /// The blocks, in order.
    pub blocks: Vec<Block>,
}

/// A named group of points; output files carry the name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Block {
    /// Name, unique within the grid; at most 31 letters, digits, `_` and `-`.
    pub name: String,
    /// Coordinates of the points.
    pub places: Places,
}

/// Coordinates of points.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Places {
    /// Product of the axes x, y and z \[m\], each strictly increasing.
    Lattice([Vec<f64>; 3]),
    /// Individual points \[m\].
    List(Vec<[f64; 3]>),
}

impl Places {
    /// Returns the number of points.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Lattice(axes) => axes.iter().map(Vec::len).fold(1, usize::saturating_mul),
            Self::List(points) => points.len(),
        }
    }

    /// Returns the point whose value stands at `index` \[m\].
    #[must_use]
    pub fn point(&self, index: usize) -> [f64; 3] {
        match self {
            Self::Lattice([x, y, z]) => {
                let row = index / x.len();
                [x[index % x.len()], y[row % y.len()], z[row / y.len()]]
            }
            Self::List(points) => points[index],
        }
    }

    fn check(&self) -> Result<(), String> {
        if !(1..=MOST).contains(&self.count()) {
            return Err(format!("it has {} points", self.count()));
        }
        let finite = match self {
            Self::Lattice(axes) => axes.iter().flatten().all(|value| value.is_finite()),
            Self::List(points) => points.as_flattened().iter().all(|value| value.is_finite()),
        };
        let rises = match self {
            Self::Lattice(axes) => {
                axes.iter().all(|axis| axis.windows(2).all(|pair| pair[0] < pair[1]))
            }
            Self::List(_) => true,
        };
        match (finite, rises) {
            (true, true) => Ok(()),
            (false, _) => Err("a coordinate is not finite".to_owned()),
            (_, false) => Err("an axis does not rise".to_owned()),
        }
    }
}

impl Points {
    /// Returns the number of points of all blocks.
    #[must_use]
    pub fn count(&self) -> usize {
        self.blocks.iter().map(|block| block.places.count()).fold(0, usize::saturating_add)
    }

    /// Returns the point whose value stands at `index` \[m\].
    ///
    /// # Panics
    /// Panics if the index is out of range.
    #[must_use]
    pub fn point(&self, index: usize) -> [f64; 3] {
        let mut left = index;
        for block in &self.blocks {
            let count = block.places.count();
            if left < count {
                return block.places.point(left);
            }
            left -= count;
        }
        panic!("there is no point {index}")
    }

    /// Returns every block with the index of its first point.
    pub fn parts(&self) -> impl Iterator<Item = (usize, &Block)> {
        self.blocks.iter().scan(0, |next, block| {
            let first = *next;
            *next += block.places.count();
            Some((first, block))
        })
    }

    /// Checks points received from another process, except the names of blocks.
    pub(super) fn check(&self) -> Result<(), String> {
        for (index, block) in self.blocks.iter().enumerate() {
            let name = &block.name;
            if self.blocks[..index].iter().any(|other| other.name == *name) {
                return Err(format!("block `{name}` is defined twice"));
            }
            block.places.check().map_err(|why| format!("block `{name}`: {why}"))?;
        }
        match self.count() {
            1..=MOST => Ok(()),
            count => Err(format!("it has {count} points")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Grid, Shape};
    use super::*;

    fn points() -> Points {
        let lattice = Places::Lattice([vec![0.0, 1.0], vec![5.0], vec![-3.0, -2.0, -1.0]]);
        let list = Places::List(vec![[0.5, 0.25, -7.0], [0.1, 0.2, 0.3]]);
        let block = |name: &str, places| Block { name: name.to_owned(), places };
        Points { blocks: vec![block("box", lattice), block("list", list)] }
    }

    #[test]
    fn points_follow_each_other_block_by_block() {
        let points = points();
        assert_eq!(points.count(), 8);
        assert_eq!(points.point(3), [1.0, 5.0, -2.0]);
        assert_eq!(points.point(7), [0.1, 0.2, 0.3]);
        let firsts: Vec<usize> = points.parts().map(|(first, _)| first).collect();
        assert_eq!(firsts, [0, 6]);
    }

    /// Points keep their JSON form, do not move, and have no area.
    #[test]
    fn a_grid_of_points_travels_as_it_is() {
        let grid = Grid { name: "g".to_owned(), revision: 1, shape: Shape::Points(points()) };
        grid.check().unwrap();
        let text = serde_json::to_string(&grid).unwrap();
        assert!(
            text.contains(r#""kind":"points","blocks":[{"name":"box","places":{"lattice":"#),
            "{text}"
        );
        assert_eq!(serde_json::from_str::<Grid>(&text).unwrap(), grid);
        assert_eq!((grid.points(), grid.centre(3), grid.area(3)), (8, [1.0, 5.0, -2.0], 0.0));
        assert!(grid.only_written() && !grid.is_volume());
        assert!(grid.displaced(&[0.0; 24]).unwrap_err().contains("points"));
    }

    #[test]
    fn points_from_outside_are_checked() {
        let mut named = points();
        named.blocks[1].name = "../x".to_owned();
        let grid = Grid { name: "g".to_owned(), revision: 1, shape: Shape::Points(named) };
        assert!(grid.check().unwrap_err().contains("../x"));
        let with = |change: fn(&mut Points)| {
            let mut points = points();
            change(&mut points);
            points.check().unwrap_err()
        };
        assert!(with(|points| points.blocks.clear()).contains("0 points"));
        assert!(with(|points| points.blocks[1].name = "box".to_owned()).contains("twice"));
        let nan = |points: &mut Points| points.blocks[1].places = Places::List(vec![[f64::NAN; 3]]);
        assert!(with(nan).contains("not finite"));
        let falls = |points: &mut Points| {
            points.blocks[0].places = Places::Lattice([vec![1.0, 1.0], vec![0.0], vec![0.0]]);
        };
        assert!(with(falls).contains("does not rise"));
    }
}
