//! Where the sun stands in the sky of a place at a time.

use crate::math::float::{atan2_f64, sin_cos_degrees};

/// Direction towards the sun as seen from a place on the earth, without refraction by the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunPosition {
    /// Elevation above the horizon (degrees).
    pub elevation: f64,
    /// Azimuth from north through east, from 0 to 360 (degrees).
    pub azimuth: f64,
}

/// Noon of 1 January 2000 in seconds since the start of 1970 (UTC).
const EPOCH: f64 = 946_728_000.0;

impl SunPosition {
    /// The position for a place and a time, to 0.01° between the years 1900 and 2100.
    ///
    /// - `latitude`, `longitude`: of the place, north and east positive (degrees)
    /// - `seconds`: time since the start of 1970 (UTC)
    ///
    /// Source: Meeus, *Astronomical Algorithms* (1998), chapters 12, 13 and 25. The parallax of the sun, 0.002°, is left out.
    /// Tests: the_sun_stands_where_almanacs_say.
    pub fn new(latitude: f64, longitude: f64, seconds: f64) -> SunPosition {
        let days = (seconds - EPOCH) / 86_400.0;
        let t = days / 36_525.0;
        let [sin, cos] = [|degrees| sin_cos_degrees(degrees).0, |degrees| sin_cos_degrees(degrees).1];
        // The apparent longitude of the sun: its mean longitude, the equation of the centre, aberration and nutation.
        let mean = 280.466_46 + 36_000.769_83 * t + 0.000_303_2 * t * t;
        let anomaly = 357.529_11 + 35_999.050_29 * t - 0.000_153_7 * t * t;
        let center =
            (1.914_602 - 0.004_817 * t) * sin(anomaly) + (0.019_993 - 0.000_101 * t) * sin(2.0 * anomaly) + 0.000_289 * sin(3.0 * anomaly);
        let node = 125.04 - 1_934.136 * t;
        let lambda = mean + center - 0.005_69 - 0.004_78 * sin(node);
        // The axis of the earth is inclined to its orbit.
        let tilt = 23.439_291 - 0.013_004_2 * t + 0.002_56 * cos(node);
        let (x, y, z) = (cos(lambda), cos(tilt) * sin(lambda), sin(tilt) * sin(lambda));
        // Local sidereal time, which turns the meridian of the place away from the vernal equinox.
        let meridian = 280.460_618_37 + 360.985_647_366_29 * days + 0.000_387_933 * t * t + longitude;
        let (south, east) = (x * cos(meridian) + y * sin(meridian), y * cos(meridian) - x * sin(meridian));
        let up = cos(latitude) * south + sin(latitude) * z;
        let north = cos(latitude) * z - sin(latitude) * south;
        let degrees = |radians: f64| radians * (180.0 / std::f64::consts::PI);
        SunPosition { elevation: degrees(atan2_f64(up, north.hypot(east))), azimuth: degrees(atan2_f64(east, north)).rem_euclid(360.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Examples of two publications. Seen from a pole, the sun is as high as its declination.
    ///
    /// Reda and Andreas, *Solar Position Algorithm for Solar Radiation Applications* (2008), appendix A.5: Golden, Colorado, on 17 October
    /// 2003 at 12:30:30, seven hours after UTC. Meeus, example 25.a: 13 October 1992 at 0 h.
    #[test]
    fn the_sun_stands_where_almanacs_say() {
        let golden = SunPosition::new(39.742_476, -105.178_6, 1_066_419_030.0);
        assert!((golden.elevation - 39.872_046).abs() < 0.01, "{golden:?}");
        assert!((golden.azimuth - 194.340_241).abs() < 0.015, "{golden:?}");
        let pole = SunPosition::new(90.0, 0.0, 718_934_400.0);
        assert!((pole.elevation + 7.785_07).abs() < 0.01, "{pole:?}");
    }

    /// At the equator the sun of an equinox rises in the east, passes near the zenith and sets in the west; the time of noon moves by four
    /// minutes with each degree of longitude.
    #[test]
    fn the_sun_rises_in_the_east() {
        // 20 March 2026, 12:00 UTC.
        let noon = 1_774_008_000.0;
        let [morning, midday, evening] = [-5.0, 0.0, 5.0].map(|hours| SunPosition::new(0.0, 0.0, noon + 3600.0 * hours));
        assert!((morning.azimuth - 90.0).abs() < 1.0 && (morning.elevation - 13.0).abs() < 1.0, "{morning:?}");
        assert!(midday.elevation > 87.0, "{midday:?}");
        assert!((evening.azimuth - 270.0).abs() < 1.0 && (evening.elevation - 17.0).abs() < 1.0, "{evening:?}");
        let moved = SunPosition::new(0.0, 15.0, noon - 6.0 * 3600.0);
        assert!((moved.elevation - morning.elevation).abs() < 0.1, "{moved:?}, {morning:?}");
    }
}
