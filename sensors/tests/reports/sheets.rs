//! The published figures of scanners.

/// The published figures of a scanner, in degrees, metres and seconds.
pub(crate) struct Sheet {
    pub(crate) name: &'static str,
    pub(crate) device: String,
    pub(crate) source: &'static str,
    pub(crate) notes: &'static str,
    pub(crate) lasers: f64,
    /// The elevations of the lowest and the highest laser.
    pub(crate) elevation: [f64; 2],
    /// The largest deviation of a unit from these.
    pub(crate) elevation_bound: f64,
    /// The largest distance of a beam's origin from the centre.
    pub(crate) off_middle: f64,
    /// The horizontal field of view, and the angle between successive firings of a laser if the scanner turns.
    pub(crate) across: f64,
    pub(crate) step: Option<f64>,
    pub(crate) firings_per_s: f64,
    pub(crate) range: [f64; 2],
    /// The standard deviation at a range.
    pub(crate) stddev: fn(f64) -> f64,
    /// The quantum of which all ranges are multiples.
    pub(crate) quantum: f64,
}

/// The published figures of a preset.
pub(crate) fn sheet(name: &str) -> Sheet {
    sheets()
        .into_iter()
        .chain(ousters())
        .find(|sheet| sheet.name == name)
        .unwrap_or_else(|| panic!("{name} has no report"))
}

fn sheets() -> Vec<Sheet> {
    vec![
        Sheet {
            name: "vlp16",
            device: "Velodyne VLP-16 (Puck)".into(),
            source: "VLP-16 User Manual 63-9243: firings, angles, ±3 cm",
            notes: "At 10 turns a second. The manual promises an accuracy; a third of it is taken as σ.",
            lasers: 16.0,
            elevation: [-15.0, 15.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 360.0,
            step: Some(55.296e-6 * 10.0 * 360.0),
            firings_per_s: 16.0 / 55.296e-6,
            range: [1.0, 100.0],
            stddev: |_| 0.01,
            quantum: 0.002,
        },
        Sheet {
            name: "hdl32e",
            device: "Velodyne HDL-32E".into(),
            source: "HDL-32E User's Manual: firings, angles, ±2 cm",
            notes: "At 10 turns a second. The manual promises an accuracy; a third of it is taken as σ.",
            lasers: 32.0,
            elevation: [-30.67, 10.67],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 360.0,
            step: Some(46.08e-6 * 10.0 * 360.0),
            firings_per_s: 32.0 / 46.08e-6,
            range: [0.05, 100.0],
            stddev: |_| 0.02 / 3.0,
            quantum: 0.002,
        },
        Sheet {
            name: "vls128",
            device: "Velodyne VLS-128 (Alpha Prime)".into(),
            source: "VLS-128 User Manual 63-9483: firings, ±3 cm, 4 mm; angles as VeloView's calibration has them",
            notes: "At 10 turns a second. The manual promises an accuracy; a third of it is taken as σ.",
            lasers: 128.0,
            elevation: [-25.0, 15.0],
            elevation_bound: 1e-3,
            off_middle: 0.028,
            across: 360.0,
            step: Some(53.3e-6 * 10.0 * 360.0),
            firings_per_s: 128.0 / 53.3e-6,
            range: [0.4, 245.0],
            stddev: |_| 0.01,
            quantum: 0.004,
        },
        Sheet {
            name: "mid70",
            device: "Livox Mid-70".into(),
            source: "Data sheet: 70.4°, 100 000 points a second, σ 20 mm; speeds of the prisms of the Mid-40 by Brazeal et al. 2021; Livox's scan table",
            notes: "Its cone is filled as time goes on: in a tenth of a second beams do not come to its edge everywhere. All 400 000 directions of the table that Livox published for its simulation follow from two wedges of 18° and 1.8144, the flat sides inwards, within 0.001°.",
            lasers: 1.0,
            elevation: [-35.2, 35.2],
            elevation_bound: 0.5,
            off_middle: 2e-3,
            across: 70.4,
            step: None,
            firings_per_s: 100_000.0,
            range: [0.05, 90.0],
            stddev: |_| 0.02,
            quantum: 0.001,
        },
        Sheet {
            name: "mid360",
            device: "Livox Mid-360".into(),
            source: "Data sheet: 360° × −7° to 52°, 200 000 points a second, σ 20 mm at 10 m and 30 mm at 0.2 m, from 0.1 m on, 70 m at 80 %; Livox's scan table",
            notes: "σ is taken as 30 mm up to 1 m, and 20 mm from there on. Four lasers fire at once, through a wedge and by a mirror that turn: the law was found by fitting the table of 800 000 directions that Livox published for its simulation, which is rounded to 0.01°. Half of the directions are within 0.0034° of it, 95 % within 0.007°, all within 0.01°; shares of points by elevation within 0.02 %. The table goes from −7.21° to 52.16°. The data sheet's angular error (less than 0.15°) is left out.",
            lasers: 4.0,
            elevation: [-7.0, 52.0],
            elevation_bound: 0.5,
            off_middle: 2e-3,
            across: 360.0,
            step: None,
            firings_per_s: 200_000.0,
            range: [0.1, 70.0],
            stddev: |range| if range < 1.0 { 0.03 } else { 0.02 },
            quantum: 0.001,
        },
        Sheet {
            name: "hap",
            device: "Livox HAP (TX)".into(),
            source: "HAP (TX) User Manual v1.0: 120° × 25°, 452 000 points a second, σ 20 mm and ±30 mm at 20 m, 0.5 m to 150 m at 10 %, 0.03° × 0.28°; Livox's scan table",
            notes: "Six lasers look through three wedges that turn: the law was found by fitting the table of 1 048 575 directions that Livox published for its simulation. In the first tenth of a second half of the directions are within 0.006° of it and all within 0.016°; as the speeds are told in whole turns a minute, 0.3° after 2.3 s. The table has 425 000 firings a second, and 550 000 in the middle 40° × 12°; here firings are even, so that 22 % of the points are there instead of 26 %, and the distributions of azimuth and elevation are 0.021 and 0.016 apart (Kolmogorov–Smirnov). The table reaches ±60.25° and ±13.25°. The manual's angular error (σ less than 0.1°) is left out.",
            lasers: 6.0,
            elevation: [-12.5, 12.5],
            elevation_bound: 0.8,
            off_middle: 2e-3,
            across: 120.0,
            step: None,
            firings_per_s: 452_000.0,
            range: [0.5, 150.0],
            stddev: |_| 0.02,
            quantum: 0.001,
        },
        Sheet {
            name: "hfl110",
            device: "Continental HFL110".into(),
            source: "Its driver: 128 × 32 pixels, 50 m in 65536 steps; announcements: 120° × 30°, 25 Hz",
            notes: "The field is from the middle of the first pixel to that of the last; it and the rate are not from a data sheet. σ is not published: 20 mm is assumed.",
            lasers: 32.0,
            elevation: [-15.0 + 15.0 / 32.0, 15.0 - 15.0 / 32.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 120.0 * 127.0 / 128.0,
            step: None,
            firings_per_s: 128.0 * 32.0 * 25.0,
            range: [0.1, 50.0],
            stddev: |_| 0.02,
            quantum: 50.0 / 65_536.0,
        },
        Sheet {
            name: "urg04lx",
            device: "Hokuyo URG-04LX".into(),
            source: "Specification C-42-03320: ±10 mm up to 1 m, ±1 % beyond, 1 mm, 1024 steps a turn of which 682 are measured",
            notes: "A third of the promised accuracy is taken as σ.",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 681.0 * 360.0 / 1024.0,
            step: Some(360.0 / 1024.0),
            firings_per_s: 6820.0,
            range: [0.02, 5.6],
            stddev: |range| 0.01 / 3.0 * range.max(1.0),
            quantum: 0.001,
        },
        Sheet {
            name: "utm30lx",
            device: "Hokuyo UTM-30LX".into(),
            source: "Specification: σ < 10 mm up to 10 m, < 30 mm up to 30 m, 0.25°, 270°, 40 Hz, 1 mm",
            notes: "",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 270.0,
            step: Some(0.25),
            firings_per_s: 1081.0 * 40.0,
            range: [0.1, 30.0],
            stddev: |range| if range < 10.0 { 0.01 } else { 0.03 },
            quantum: 0.001,
        },
        Sheet {
            name: "lms111",
            device: "SICK LMS111".into(),
            source: "Operating instructions: statistical error σ 12 mm, 0.25° at 25 Hz, 270°",
            notes: "Its systematic error of ±30 mm is a bias of each run, of a third of that.",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 270.0,
            step: Some(0.25),
            firings_per_s: 1081.0 * 25.0,
            range: [0.5, 20.0],
            stddev: |_| 0.012,
            quantum: 0.001,
        },
        Sheet {
            name: "lms511",
            device: "SICK LMS511".into(),
            source: "Operating instructions 8013796: 190° by 0.1667° at 25 Hz; statistical error σ 6, 8 and 14 mm up to 10, \
                     20 and 30 m",
            notes: "Its systematic error of ±25 mm and more is a bias of each run, of a third of that.",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 190.0,
            step: Some(1.0 / 6.0),
            firings_per_s: 1141.0 * 25.0,
            range: [0.7, 80.0],
            stddev: |range| {
                if range < 10.0 {
                    0.006
                } else if range < 20.0 {
                    0.008
                } else {
                    0.014
                }
            },
            quantum: 0.001,
        },
        Sheet {
            name: "rplidar_a1",
            device: "Slamtec RPLIDAR A1M8".into(),
            source: "Data sheet rev. 1.0: 0.15 … 12 m, 1° at 5.5 Hz; an error of triangulation of 3.3e-4·r² is derived from \
                     its < 0.5 mm below 1.5 m and < 1 %",
            notes: "",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 360.0,
            step: Some(1.0),
            firings_per_s: 1980.0,
            range: [0.15, 12.0],
            stddev: |range| 3.3e-4 * range * range,
            quantum: 0.000_25,
        },
        Sheet {
            name: "rplidar_a2",
            device: "Slamtec RPLIDAR A2M8".into(),
            source: "Data sheet rev. 2.5: 0.2 … 12 m, 0.45° at 10 Hz, < 1 %",
            notes: "A third of the promised accuracy is taken as σ.",
            lasers: 1.0,
            elevation: [0.0, 0.0],
            elevation_bound: 1e-3,
            off_middle: 2e-3,
            across: 360.0,
            step: Some(0.45),
            firings_per_s: 8000.0,
            range: [0.2, 12.0],
            stddev: |range| 0.01 / 3.0 * range,
            quantum: 0.000_25,
        },
    ]
}

/// Ouster's heads, by the number of lasers and the elevations of the highest and lowest beam.
fn ousters() -> impl Iterator<Item = Sheet> {
    let names = ["os0_32", "os0_64", "os0_128", "os1_32", "os1_64", "os1_128", "os2_32", "os2_64", "os2_128"];
    let highest = [43.28, 44.80, 45.75, 20.55, 21.20, 21.51, 10.27, 10.60, 10.76];
    names.into_iter().enumerate().map(move |(index, name)| {
        let (kind, lasers) = (index / 3, [32.0, 64.0, 128.0][index % 3]);
        Sheet {
            name,
            device: format!("Ouster OS{kind}-{lasers}"),
            source: "Metadata of units of 128 lasers in ouster_example: angles, where beams start; OS1 data sheet: σ 15 mm \
                     where the return is strong; User Guide v1.14: lidar_mode",
            notes: "At 1024x10. Each unit has angles of its own; those of the heads with fewer lasers are every second or \
                    fourth, by the polynomial. Published σ of OS0 and OS2 are not known to us: that of the OS1 is taken.",
            lasers,
            elevation: [[-46.26, -21.44, -11.09][kind], highest[index]],
            elevation_bound: [0.25, 0.05, 0.03][kind],
            off_middle: [0.064, 0.052, 0.092][kind],
            across: 360.0,
            step: Some(360.0 / 1024.0),
            firings_per_s: 10_240.0 * lasers,
            range: [[0.3, 55.0], [0.8, 120.0], [1.0, 240.0]][kind],
            stddev: |_| 0.015,
            quantum: 0.001,
        }
    })
}
