//! The section on bytes by content.

use super::values::{short, thousands};
use taotie_io::GltfSizes;
use taotie_report::table::Table;

/// Returns the table of bytes in the file and on the graphics card.
pub fn lines(sizes: &GltfSizes) -> String {
    let mut table = Table::new(&["", ">bytes", ">GPU bytes"]);
    let mut row = |name: &str, bytes: Option<u64>, gpu_bytes: Option<u64>| {
        let cell = |bytes: Option<u64>| bytes.map_or_else(String::new, thousands);
        table.row([short(name), cell(bytes), cell(gpu_bytes)]);
    };
    row("JSON", Some(sizes.json), None);
    for size in
        sizes.attributes.iter().chain([&sizes.indices]).filter(|size| size.bytes > 0 || size.gpu_bytes > 0)
    {
        row(&size.name, Some(size.bytes), Some(size.gpu_bytes));
    }
    sizes.images.iter().for_each(|image| row(&image.name, Some(image.bytes), Some(image.gpu_bytes)));
    let others = [("animations and skins", sizes.animations), ("other", sizes.other)];
    others.into_iter().filter(|(_, bytes)| *bytes > 0).for_each(|(name, bytes)| row(name, Some(bytes), None));
    row("all", Some(sizes.bytes()), Some(sizes.gpu_bytes));
    table.filled_lines(2)
}
