//! A picture of grey values: edges and circles are found in it.

/// Grey values, row by row.
#[derive(Debug, Clone)]
pub struct GreyImage {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width` · `height` values.
    pub values: Vec<f32>,
}

impl GreyImage {
    /// Returns the value at a point in pixels, (0.5, 0.5) being the centre of the first, interpolated; points outside
    /// have the value of the border.
    pub fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, above) = (x.floor(), y.floor());
        let clamped = |v: f64, side: usize| v.clamp(0.0, side as f64 - 1.0) as usize;
        let value = |dx: f64, dy: f64| {
            let (x, y) = (clamped(left + dx, self.width), clamped(above + dy, self.height));
            f64::from(self.values[y * self.width + x])
        };
        let (u, v) = (x - left, y - above);
        let row = |dy: f64| value(0.0, dy) * (1.0 - u) + value(1.0, dy) * u;
        row(0.0) * (1.0 - v) + row(1.0) * v
    }

    /// Returns the picture with squares of `size` pixels averaged.
    pub fn reduced(&self, size: usize) -> Self {
        let [width, height] = [self.width / size, self.height / size].map(|side| side.max(1));
        let mean = |i: usize| {
            let (x, y) = (i % width * size, i / width * size);
            let (right, below) = ((x + size).min(self.width), (y + size).min(self.height));
            let rows = (y..below).map(|y| &self.values[y * self.width + x..y * self.width + right]);
            rows.flatten().sum::<f32>() / ((right - x) * (below - y)) as f32
        };
        Self { width, height, values: (0..width * height).map(mean).collect() }
    }

    /// Returns the gradient of each pixel by Sobel's operator; zero at the border.
    pub fn gradients(&self) -> Vec<[f64; 2]> {
        let mut gradients = vec![[0.0; 2]; self.values.len()];
        for y in 1..self.height.saturating_sub(1) {
            for x in 1..self.width.saturating_sub(1) {
                let v = |dx: usize, dy: usize| f64::from(self.values[(y + dy - 1) * self.width + x + dx - 1]);
                let across = v(2, 0) + 2.0 * v(2, 1) + v(2, 2) - v(0, 0) - 2.0 * v(0, 1) - v(0, 2);
                let down = v(0, 2) + 2.0 * v(1, 2) + v(2, 2) - v(0, 0) - 2.0 * v(1, 0) - v(2, 0);
                gradients[y * self.width + x] = [across / 8.0, down / 8.0];
            }
        }
        gradients
    }
}
