//! The output and files of `taotie compare --paper`.

use super::place::Place;
use serde::Deserialize;
use snapbox::str;

#[test]
fn the_tables_are_told_in_full() {
    let place = Place::new();
    place.taotie("compare --paper").assert().success().stderr_eq("").stdout_eq(str![[r#"
Guo and Wang 2025, Tables 2 and 3, recomputed
  Guo Huifang and Wang Junxiu, "Analysis and application of Physically-Based Rendering (PBR) normal mapping
  technology in bronze wares", Intelligent Computer and Applications 15(6), 2025, pp. 122–126,
  doi:10.20169/j.issn.2095-2163.24121501.
  N1 is the mesh normal, N2 and N3 are those of the bump method with factors s = 5 and s = 50, and N4 is that
  of the paper's own method; θ1, θ2 and θ3 are the angles of N2, N3 and N4 to N1; g is half the difference
  between two grey levels of the height map.
  The paper truncates decimals: it prints four for normals and two for angles. A printed number therefore
  represents a range, and agrees with others if some numbers in their ranges would be printed this way. Angles
  are arccos(a·b / (|a||b|)).
  In each row, g is the multiple of one half that agrees with most of the row's numbers. N4 cannot be
  recomputed, since neither the mesh nor its textures were published.

The law of N2 and N3: n + s · (g/255) · (1, 1, 0), with s = 5 and 50
  row   N2.x   N2.y   N3.x   N3.y     g  numbers that agree
    1   1.50  14.11   1.50   1.50   1.5              8 of 9
    2  -2.00  -2.00  -2.00  -2.00    -2              9 of 9
    3   6.50   6.50   0.54   6.09   6.5              7 of 9
    4  -0.97  -1.00  -1.00  -1.00    -1              8 of 9
    5  -3.00  -3.00  -3.00  -3.00    -3              9 of 9
    6   1.00   1.00   1.00   1.00     1              9 of 9
    7  21.00  21.00  21.00  21.00    21              9 of 9
    8  11.47  13.00  12.85  13.00    13              8 of 9
    9  -4.50  -4.50  -4.50  -4.50  -4.5              9 of 9
   10   2.50   2.50   2.50   2.50   2.5              9 of 9

Table 2, normals at ten points of the jue
  row      printed x        y       z  recomputed x        y       z
    1  N1     0.5334  -0.6374  0.5556        0.5334  -0.6374  0.5556  agrees
       N2     0.5628  -0.3608  0.5556        0.5628  -0.6080  0.5556  y DIFFERS
       N3     0.8275  -0.3433  0.5556        0.8275  -0.3433  0.5556  agrees
       N4     0.7425  -0.1102  0.5192             –        –       –  cannot be recomputed
    2  N1     0.5324  -0.6379  0.5554        0.5324  -0.6379  0.5554  agrees
       N2     0.4932  -0.6771  0.5554        0.4932  -0.6771  0.5554  agrees
       N3     0.1402  -1.0301  0.5554        0.1402  -1.0301  0.5554  agrees
       N4     0.6654  -0.2239  0.5324             –        –       –  cannot be recomputed
    3  N1     0.5297  -0.6388  0.5562        0.5297  -0.6388  0.5562  agrees
       N2     0.6571  -0.5113  0.5562        0.6571  -0.5113  0.5562  agrees
       N3     0.6356   0.5562  0.5562        1.8042   0.6356  0.5562  x and y DIFFER
       N4     0.7503  -0.1474  0.4980             –        –       –  cannot be recomputed
    4  N1     0.5270  -0.6396  0.5570        0.5270  -0.6396  0.5570  agrees
       N2     0.5079  -0.6592  0.5570        0.5074  -0.6592  0.5570  x DIFFERS
       N3     0.3309  -0.8357  0.5570        0.3309  -0.8357  0.5570  agrees
       N4     0.6133  -0.3605  0.5298             –        –       –  cannot be recomputed
    5  N1     0.5242  -0.6405  0.5578        0.5242  -0.6405  0.5578  agrees
       N2     0.4654  -0.6993  0.5578        0.4654  -0.6993  0.5578  agrees
       N3    -0.0639  -1.2288  0.5578       -0.0639  -1.2288  0.5578  agrees
       N4     0.6957  -0.0848  0.5388             –        –       –  cannot be recomputed
    6  N1     0.5215  -0.6414  0.5586        0.5215  -0.6414  0.5586  agrees
       N2     0.5411  -0.6218  0.5586        0.5411  -0.6218  0.5586  agrees
       N3     0.7176  -0.4453  0.5586        0.7176  -0.4453  0.5586  agrees
       N4     0.7272  -0.0756  0.5308             –        –       –  cannot be recomputed
    7  N1     0.5341  -0.6375  0.5543        0.5341  -0.6375  0.5543  agrees
       N2     0.9459  -0.2257  0.5543        0.9459  -0.2257  0.5543  agrees
       N3     4.6518   3.4800  0.5543        4.6518   3.4800  0.5543  agrees
       N4     0.8798   0.1842  0.4347             –        –       –  cannot be recomputed
    8  N1     0.5614  -0.6384  0.5551        0.5314  -0.6384  0.5551  x DIFFERS
       N2     0.7863  -0.3835  0.5551        0.7863  -0.3835  0.5551  agrees
       N3     3.0804   1.9105  0.5551        3.0804   1.9105  0.5551  agrees
       N4     0.7279  -0.2330  0.4493             –        –       –  cannot be recomputed
    9  N1     0.5287  -0.6393  0.5559        0.5287  -0.6393  0.5559  agrees
       N2     0.4405  -0.7275  0.5559        0.4405  -0.7275  0.5559  agrees
       N3    -0.3536  -1.5216  0.5559       -0.3536  -1.5216  0.5559  agrees
       N4     0.5080  -0.5685  0.4988             –        –       –  cannot be recomputed
   10  N1     0.5260  -0.6401  0.5567        0.5260  -0.6401  0.5567  agrees
       N2     0.5750  -0.5911  0.5567        0.5750  -0.5911  0.5567  agrees
       N3     1.0162  -0.1499  0.5567        1.0162  -0.1499  0.5567  agrees
       N4     0.6676  -0.0944  0.5423             –        –       –  cannot be recomputed

Table 3, their angles in degrees
  row      printed  from Table 2 as printed           from Table 2 corrected                     follows from N1 and g
    1  θ1     2.38           15.13 to 15.15  DIFFERS            2.37 to 2.39  agrees             yes
       θ2    23.17           23.16 to 23.17  agrees           23.16 to 23.17  agrees             yes
       θ3    34.19           34.17 to 34.19  agrees           34.17 to 34.19  agrees             –
    2  θ1     3.15             3.14 to 3.16  agrees             3.14 to 3.16  agrees             yes
       θ2    27.93           27.97 to 27.99  DIFFERS          27.97 to 27.99  agrees with 27.98  no
       θ3    25.80           25.79 to 25.81  agrees           25.79 to 25.81  agrees             –
    3  θ1    10.33           10.32 to 10.34  agrees           10.32 to 10.34  agrees             yes
       θ2    64.42           73.26 to 73.28  DIFFERS          64.42 to 64.43  agrees             yes
       θ3    32.52           32.51 to 32.53  agrees           32.51 to 32.53  agrees             –
    4  θ1     1.58             1.55 to 1.56  DIFFERS            1.57 to 1.58  agrees             yes
       θ2    15.15           15.14 to 15.16  agrees           15.14 to 15.16  agrees             yes
       θ3    16.58           16.56 to 16.58  agrees           16.56 to 16.58  agrees             –
    5  θ1     4.71             4.70 to 4.72  agrees             4.70 to 4.72  agrees             yes
       θ2    37.85           37.84 to 37.86  agrees           37.84 to 37.86  agrees             yes
       θ3    35.35           35.35 to 35.36  agrees           35.35 to 35.36  agrees             –
    6  θ1     1.58             1.58 to 1.59  agrees             1.58 to 1.59  agrees             yes
       θ2    15.83           15.82 to 15.84  agrees           15.82 to 15.84  agrees             yes
       θ3    36.53           36.52 to 36.54  agrees           36.52 to 36.54  agrees             –
    7  θ1    31.25           31.24 to 31.26  agrees           31.24 to 31.26  agrees             yes
       θ2    84.35           84.35 to 84.36  agrees           84.35 to 84.36  agrees             yes
       θ3    53.51           53.50 to 53.52  agrees           53.50 to 53.52  agrees             –
    8  θ1    20.29           19.03 to 19.04  DIFFERS          20.28 to 20.30  agrees             yes
       θ2    78.57           77.30 to 77.31  DIFFERS          78.57 to 78.58  agrees             yes
       θ3    27.58           26.31 to 26.33  DIFFERS          27.58 to 27.60  agrees             –
    9  θ1     7.03             7.02 to 7.03  agrees             7.02 to 7.03  agrees             yes
       θ2    48.60           48.60 to 48.61  agrees           48.60 to 48.61  agrees             yes
       θ3     1.93             1.92 to 1.94  agrees             1.92 to 1.94  agrees             –
   10  θ1     3.98             3.97 to 3.98  agrees             3.97 to 3.98  agrees             yes
       θ2    36.25           36.24 to 36.26  agrees           36.24 to 36.26  agrees             yes
       θ3    34.30           34.28 to 34.30  agrees           34.28 to 34.30  agrees             –
  23 of 30 printed angles follow from Table 2 as printed, and 30 after correcting 5 misprints. From just N1
  and g, the law gives 19 of the 20 angles θ1 and θ2 as printed.

Misprints in the journal or in the transcribed copy
  Table 2, row 1, N2.y: printed -0.3608, should be -0.6080
      g = 1.5 explains 8 of the row's 9 numbers and puts y between -0.60809 and -0.60801.
  Table 2, row 3, N3: printed (0.6356, 0.5562, 0.5562), should be (1.8042, 0.6356, 0.5562)
      g = 6.5 explains 7 of the row's 9 numbers and puts x between 1.80421 and 1.80426 and y between 0.63566
      and 0.63571; y and z are printed one column too far left, and x is lost.
  Table 2, row 4, N2.x: printed 0.5079, should be 0.5074
      g = -1 explains 8 of the row's 9 numbers and puts x between 0.50739 and 0.50747.
  Table 2, row 8, N1.x: printed 0.5614, should be 0.5314
      g = 13 explains 8 of the row's 9 numbers and puts x between 0.53140 and 0.53148.
  Table 3, row 2, θ2: printed 27.93, should be 27.98
      all numbers of N1 and N3 follow the law with g = -2, and the angle is 27.981° to 27.983°.

Conclusion
  Bump 5 is closer to the paper's own method (N4) than bump 50: at 7 of 10 points, and with a mean of 24.5°
  instead of 36.6° (as printed: 7 points, 23.3° and 37.7°). The paper states for its Figure 8 that bump 5 is
  far from its own method and that bump 50 is much the same; Tables 2 and 3 do not support this.
  The paper's bump method moves the normal along (1, 1, 0) in object space regardless of how the surface
  faces, and does not normalise it: the length of N1 is 0.998 to 1.000, that of N3 up to 5.84, and that of N4
  0.87 to 1.00.

"#]]);
    assert_eq!(place.files(), [""; 0], "nothing is written without -o");
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct Document {
    schema: u32,
    version: String,
    source: String,
    law: String,
    rows: Vec<Row>,
    misprints: Vec<Misprint>,
    agreeing: Agreeing,
    conclusion: Conclusion,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct Row {
    row: usize,
    law: Law,
    n4: [f64; 3],
    angles_as_printed: [Angle; 3],
    angles_corrected: [Angle; 3],
    explained: [bool; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct Law {
    g: f64,
    estimates: [f64; 4],
    agreeing: usize,
    normals: [[Number; 3]; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct Number {
    printed: f64,
    range: [f64; 2],
    recomputed: f64,
    agrees: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct Angle {
    printed: f64,
    range: [f64; 2],
    agrees: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct Misprint {
    table: u32,
    row: usize,
    cell: String,
    printed: Vec<f64>,
    corrected: Vec<f64>,
    reason: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct Agreeing {
    of: usize,
    as_printed: usize,
    corrected: usize,
    explained_by_the_law: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct Conclusion {
    corrected: Distance,
    as_printed: Distance,
    lengths: [[f64; 2]; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)]
struct Distance {
    mean_bump_5: f64,
    mean_bump_50: f64,
    bump_5_is_nearer: usize,
}

#[test]
fn the_json_document() {
    let value = Place::new().json("compare --paper --json");
    let document: Document = serde_json::from_value(value).expect("the document has this form");
    assert_eq!((document.schema, document.version.as_str()), (1, env!("CARGO_PKG_VERSION")));
    let counts = &document.agreeing;
    assert_eq!((counts.as_printed, counts.corrected, counts.of), (23, 30, 30));
    assert_eq!(document.misprints.len(), 5);
    let half = document.rows.iter().map(|row| row.law.g * 2.0);
    assert_eq!(half.collect::<Vec<_>>(), [3.0, -4.0, 13.0, -2.0, -6.0, 2.0, 42.0, 26.0, -9.0, 5.0]);
    let angles = document.rows.iter().flat_map(|row| &row.angles_as_printed);
    assert_eq!(angles.filter(|angle| angle.agrees).count(), 23);
}

#[test]
fn a_folder_gets_a_page_and_the_numbers() {
    let place = Place::new();
    let assert = place.taotie("compare --paper -o made").assert().success().stderr_eq("");
    let printed = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    assert!(printed.ends_with("wrote made/paper.html\nwrote made/paper.json\n"), "{printed}");
    assert_eq!(place.files(), ["made"]);
    let stdout = place.taotie("compare --paper -o made --json").assert().success().stderr_eq("");
    assert!(stdout.get_output().stdout == place.read("made/paper.json"), "the file is what --json prints");
    let page = String::from_utf8(place.read("made/paper.html")).expect("it is text");
    assert!(page.starts_with("<!doctype html>") && page.contains("N2.y") && page.contains("misprints"));
    place.write("file", "");
    let refused = place.taotie("compare --paper -o file").assert().code(2).stdout_eq("");
    assert!(String::from_utf8_lossy(&refused.get_output().stderr).contains("file"));
}
