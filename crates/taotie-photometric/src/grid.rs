//! The pixels of a mask as a grid: which of them are neighbours.

use taotie_engine::groups::DisjointSets;

/// Marks a pixel outside the mask.
const NONE: u32 = u32::MAX;

/// A grid in which some pixels have an element.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The number of the pixel of each element, row by row.
    pub pixels: Vec<u32>,
    /// The element of each pixel.
    elements: Vec<u32>,
}

impl Grid {
    /// Makes a grid whose elements are at these pixels.
    pub fn new(width: usize, height: usize, pixels: Vec<u32>) -> Self {
        let mut elements = vec![NONE; width * height];
        for (element, pixel) in pixels.iter().enumerate() {
            elements[*pixel as usize] = element as u32;
        }
        Self { width, height, pixels, elements }
    }

    /// The column and row of an element.
    #[inline]
    pub fn position(&self, element: usize) -> [usize; 2] {
        let pixel = self.pixels[element] as usize;
        [pixel % self.width, pixel / self.width]
    }

    /// The first element of each row, and the number of elements. Elements are in the order of their pixels.
    pub fn rows(&self) -> Vec<usize> {
        let first = |y: usize| self.pixels.partition_point(|pixel| (*pixel as usize) < y * self.width);
        (0..=self.height).map(first).collect()
    }

    /// The element at a column and row, which may be outside the grid.
    #[inline]
    pub fn at(&self, x: i64, y: i64) -> Option<usize> {
        let inside = (0..self.width as i64).contains(&x) && (0..self.height as i64).contains(&y);
        let element = if inside { self.elements[y as usize * self.width + x as usize] } else { NONE };
        (element != NONE).then_some(element as usize)
    }

    /// The elements to the right, to the left, below and above.
    pub fn neighbours(&self, element: usize) -> impl Iterator<Item = usize> {
        let [x, y] = self.position(element).map(|v| v as i64);
        [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().filter_map(move |(dx, dy)| self.at(x + dx, y + dy))
    }

    /// Shifts numbers so that their mean is 0 in each part of neighbours.
    pub fn centre_parts(&self, values: &mut [f64]) {
        let mut parts = DisjointSets::new(self.pixels.len());
        for element in 0..self.pixels.len() {
            self.neighbours(element).for_each(|other| parts.join(element as u32, other as u32));
        }
        let parts = parts.into_lowest();
        let mut sums = vec![(0.0, 0.0); values.len()];
        for (part, value) in parts.iter().zip(&*values) {
            let (sum, count) = &mut sums[*part as usize];
            (*sum, *count) = (*sum + value, *count + 1.0);
        }
        for (part, value) in parts.iter().zip(values) {
            let (sum, count) = sums[*part as usize];
            *value -= sum / count;
        }
    }

    /// The element itself and its neighbours, at most nine.
    pub fn around(&self, element: usize) -> impl Iterator<Item = usize> {
        let [x, y] = self.position(element).map(|v| v as i64);
        (-1..=1)
            .flat_map(move |dy| (-1..=1).map(move |dx| (x + dx, y + dy)))
            .filter_map(|(x, y)| self.at(x, y))
    }
}
