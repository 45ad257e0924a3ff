use taotie::Progress;
use taotie::asset::{Limits, Scan, VerifyOptions, verify};
use taotie::io::{GltfPacker, GltfSource, PackedGeometry};
fn main() -> taotie::Result<()> {
    let args: Vec<String> = std::env::args().collect();
    let path = std::path::Path::new(&args[1]);
    let packer = GltfPacker::open(GltfSource::File(path), &Limits::default())?;
    for kept in [0.7, 0.5, 0.3, 0.15] {
        let glb = packer.encode(PackedGeometry { kept, ..PackedGeometry::default() }, &[])?;
        std::fs::write("/tmp/w/tp.glb", &glb).unwrap();
        let scan = Scan::read(path, &Limits::default(), Progress::SILENT)?;
        let options = VerifyOptions { map: 0, view: 11, ..VerifyOptions::default() };
        let proof = verify("/tmp/w/tp.glb", scan, &options, Progress::SILENT)?;
        let level = proof.figures.finest().unwrap();
        let angles = level.overview.angles.unwrap().summary;
        let color = level.overview.color.map(|c| c.summary);
        println!(
            "{kept} {} triangles {} bytes mean {:.3} p95 {:.3} color {:.3} {:.3} silhouette {:.2} rms {:.5}",
            level.triangles,
            glb.len(),
            angles.mean,
            angles.p95,
            color.map_or(0.0, |c| c.mean),
            color.map_or(0.0, |c| c.p95),
            level.silhouette.max_pixels,
            level.rms_of_diagonal * 100.0
        );
    }
    Ok(())
}
