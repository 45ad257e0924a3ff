//! Aligned columns of text.

/// Rows of cells under titles. Columns of numbers are right-aligned.
pub struct Table {
    right: Vec<bool>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Creates a table with these titles; a leading `>` right-aligns the column.
    pub fn new(titles: &[&str]) -> Self {
        let plain_titles = titles.iter().map(|title| title.trim_start_matches('>').to_owned());
        Self { rows: vec![plain_titles.collect()], ..Self::untitled(titles) }
    }

    /// Creates a table without titles; `>` right-aligns a column.
    pub fn untitled(columns: &[&str]) -> Self {
        Self { right: columns.iter().map(|column| column.starts_with('>')).collect(), rows: Vec::new() }
    }

    /// Adds a row with one cell for each column.
    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.into());
    }

    /// Returns the lines, indented by `indent` spaces and without trailing spaces.
    pub fn lines(&self, indent: usize) -> String {
        let widths: Vec<usize> = (0..self.right.len()).map(|column| self.width(column)).collect();
        self.rows.iter().map(|row| self.line(row, &widths, indent)).collect()
    }

    /// Like [`Table::lines`], but returns an empty string if there are only titles.
    pub fn filled_lines(&self, indent: usize) -> String {
        if self.rows.len() > 1 { self.lines(indent) } else { String::new() }
    }

    fn width(&self, column: usize) -> usize {
        let cells = self.rows.iter().map(|row| row[column].chars().count());
        cells.max().unwrap_or(0)
    }

    fn line(&self, row: &[String], widths: &[usize], indent: usize) -> String {
        let cell = |column: usize| {
            // Format widths are limited to 65,535.
            let text = &row[column];
            let gap = " ".repeat(widths[column] - text.chars().count());
            if self.right[column] { format!("{gap}{text}") } else { format!("{text}{gap}") }
        };
        let cells: Vec<String> = (0..row.len()).map(cell).collect();
        format!("{:indent$}{}\n", "", cells.join("  ").trim_end())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(&["name", ">count"]);
        table.row(["a".into(), "1,000,000".into()]);
        table.row(["düne".into(), "7".into()]);
        assert_eq!(Table::new(&["name"]).filled_lines(1), "");
        assert_eq!(table.filled_lines(1), " name      count\n a     1,000,000\n düne          7\n");
        table.row(["x".repeat(1 << 17), "1".into()]);
        let widest = table.lines(0).lines().map(|line| line.chars().count()).max();
        assert_eq!(widest, Some((1 << 17) + 2 + 9));
    }
}
