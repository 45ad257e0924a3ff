//! A wavy sheet, and photographs of it that `taotie render` makes.

use std::path::Path;
use std::process::Command;

/// Number of photographs.
pub const LIGHTS: usize = 12;

/// Returns a wavy sheet as OBJ.
pub fn waves() -> String {
    const SIDE: usize = 40;
    let mut obj = String::new();
    for i in 0..SIDE * SIDE {
        let [x, y] = [i % SIDE, i / SIDE].map(|v| 2.0 * v as f64 / (SIDE - 1) as f64 - 1.0);
        let z = 0.06 * (libm::sin(5.0 * x) + libm::sin(4.0 * y + 1.0));
        obj += &format!("v {x:.5} {y:.5} {z:.5}\n");
    }
    for (x, y) in (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).map(move |x| (x, y))) {
        let corner = y * SIDE + x + 1;
        obj += &format!("f {} {} {} {}\n", corner, corner + 1, corner + SIDE + 1, corner + SIDE);
    }
    obj
}

/// Writes `waves.obj` to a folder, photographs of it from the front, each with its light, and `dome.lp` with decimal
/// commas.
pub fn photograph(folder: &Path) {
    let write =
        |name: &str, text: String| std::fs::write(folder.join(name), text).expect("it can be written");
    write("waves.obj", waves());
    let mut lp = format!("{LIGHTS}\r\n");
    for k in 0..LIGHTS {
        let (azimuth, elevation) = (60.0 * libm::sin(k as f64 * 2.4), 50.0 * libm::cos(k as f64 * 2.4));
        let [a, e] = [azimuth, elevation].map(f64::to_radians);
        let light = [libm::sin(a) * libm::cos(e), libm::sin(e), libm::cos(a) * libm::cos(e)];
        let light = light.map(|v| format!("{v:.6}").replace('.', ","));
        lp += &format!("D:\\dome\\P{k}.EXR {}\r\n", light.join(" "));
        let direction = format!("directional from={azimuth},{elevation} strength=2");
        let mut command = Command::new(env!("CARGO_BIN_EXE_taotie"));
        command.current_dir(folder).args(["render", "waves.obj", "--light", &direction]);
        command.args(["-o", &format!("p{k}.exr"), "-q"]);
        command.args("--shading lambert --env none --orbit 0,0 --fov-deg 3 --size 64 --shadows".split(' '));
        assert!(command.status().expect("the command runs").success());
    }
    write("dome.lp", lp);
}
