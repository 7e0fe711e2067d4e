//! Tables of text with columns of coordinates: the sign between their fields, and which columns are the coordinates, by the names in the first
//! line.

/// Signs between fields, the usual ones first.
const SIGNS: [char; 4] = [',', ';', '\t', '|'];
/// Names of columns, by their letters and digits in lower case; of each pair the places are the same.
const LONGITUDES: [&str; 10] = [
    "lon",
    "lng",
    "long",
    "longitude",
    "decimallongitude",
    "gpslongitude",
    "longitudedeg",
    "londeg",
    "lonwgs84",
    "geolon",
];
const LATITUDES: [&str; 9] =
    ["lat", "latitude", "decimallatitude", "gpslatitude", "latitudedeg", "latdeg", "latwgs84", "geolat", "latit"];
const EASTINGS: [&str; 11] =
    ["x", "easting", "east", "eastings", "e", "xcoord", "coordx", "pointx", "utmx", "rechtswert", "xcoordinate"];
const NORTHINGS: [&str; 11] =
    ["y", "northing", "north", "northings", "n", "ycoord", "coordy", "pointy", "utmy", "hochwert", "ycoordinate"];
const HEIGHTS: [&str; 13] = [
    "z",
    "ele",
    "elevation",
    "alt",
    "altitude",
    "height",
    "heightm",
    "elevationm",
    "elem",
    "altitudem",
    "hoehe",
    "höhe",
    "zcoord",
];
const TEXTS: [&str; 7] = ["wkt", "wktgeom", "geomwkt", "geometrywkt", "geom", "geometry", "thegeom"];

/// Columns of coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    /// Columns of x, y and height.
    Numbers {
        x: usize,
        y: usize,
        z: Option<usize>,
        /// Whether the names say that they are longitude and latitude.
        are_degrees: bool,
    },
    /// A column of well-known text.
    Text(usize),
}

/// What the first line of a table says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Layout {
    /// Sign between fields.
    pub(crate) sign: char,
    /// Names of the columns.
    pub(crate) names: Vec<String>,
    /// The columns of coordinates; `None` if no names tell them.
    pub(crate) place: Option<Place>,
}

/// The layout of a text that begins with a line of names, with that of the possible signs which tells coordinates, else which gives the most
/// fields; `None` without any text.
pub(crate) fn layout(text: &str) -> Option<Layout> {
    let of = |sign: char| {
        let names: Vec<String> = Records::new(text, sign).next()?.fields;
        let place = place(&names);
        Some(Layout { sign, names, place })
    };
    let known = |layout: &Layout| (layout.place.is_some(), layout.names.len());
    SIGNS.into_iter().rev().filter_map(of).max_by_key(known)
}

/// Whether a text begins like a table with coordinates.
pub(crate) fn has_coordinates(text: &str) -> bool {
    layout(text).is_some_and(|layout| match layout.place {
        Some(Place::Text(_)) => layout.names.len() > 1 || layout.names[0].eq_ignore_ascii_case("wkt"),
        place => place.is_some(),
    })
}

/// The names that are looked for, in words.
pub(crate) const LOOKED_FOR: &str =
    "lon, lng, long or longitude and lat or latitude; x and y; easting and northing; or wkt or geometry";

fn place(names: &[String]) -> Option<Place> {
    let plain = |name: &String| -> String {
        name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
    };
    let names: Vec<String> = names.iter().map(plain).collect();
    let one_of = |wanted: &[&str]| wanted.iter().find_map(|name| names.iter().position(|n| n == name));
    let z = one_of(&HEIGHTS);
    let pair = |xs: &[&str], ys: &[&str], are_degrees| {
        let (x, y) = one_of(xs).zip(one_of(ys))?;
        Some(Place::Numbers { x, y, z, are_degrees })
    };
    let degrees = pair(&LONGITUDES, &LATITUDES, true);
    degrees.or_else(|| one_of(&TEXTS).map(Place::Text)).or_else(|| pair(&EASTINGS, &NORTHINGS, false))
}

/// A row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Record {
    /// Its fields, without quotes and the blanks around them.
    pub(crate) fields: Vec<String>,
    /// Whether a quote was opened and not closed.
    pub(crate) is_open: bool,
}

/// The rows of a text that are not empty (RFC 4180, with any sign between fields).
pub(crate) struct Records<'t> {
    text: &'t str,
    sign: char,
}

impl<'t> Records<'t> {
    pub(crate) fn new(text: &'t str, sign: char) -> Self {
        Self { text, sign }
    }

    /// Takes a field; returns it with the sign after it, none at the end of the text, and whether its quote stayed open.
    fn field(&mut self) -> (String, Option<char>, bool) {
        let is_end = |c: char| c == self.sign || c == '\n' || c == '\r';
        let start = self.text.trim_start_matches([' ', '\u{feff}']);
        let (mut field, mut is_open) = (String::new(), false);
        let mut rest = self.text;
        if let Some(mut inner) = start.strip_prefix('"') {
            loop {
                let Some((part, after)) = inner.split_once('"') else {
                    field.push_str(inner);
                    (rest, is_open) = ("", true);
                    break;
                };
                field.push_str(part);
                rest = after;
                // A quote inside of a field stands twice.
                let Some(after) = after.strip_prefix('"') else { break };
                field.push('"');
                inner = after;
            }
        }
        let end = rest.find(is_end).unwrap_or(rest.len());
        field.push_str(&rest[..end]);
        let sign = rest[end..].chars().next();
        self.text = &rest[end + sign.map_or(0, char::len_utf8)..];
        if sign == Some('\r') {
            self.text = self.text.strip_prefix('\n').unwrap_or(self.text);
        }
        (field.trim().trim_start_matches('\u{feff}').to_owned(), sign, is_open)
    }
}

impl Iterator for Records<'_> {
    type Item = Record;

    fn next(&mut self) -> Option<Record> {
        while !self.text.is_empty() {
            let mut record = Record { fields: Vec::new(), is_open: false };
            loop {
                let (field, sign, is_open) = self.field();
                record.fields.push(field);
                record.is_open |= is_open;
                if sign != Some(self.sign) {
                    break;
                }
            }
            if record.fields.iter().any(|field| !field.is_empty()) {
                return Some(record);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_split_as_spreadsheets_write_them() {
        let text = "\u{feff}a, \"b, \"\"c\"\"\" ,\r\n\r\n1,\"two\nlines\",3\r4,,\n5,\"open\n6";
        let rows: Vec<Record> = Records::new(text, ',').collect();
        let fields: Vec<Vec<&str>> = rows.iter().map(|r| r.fields.iter().map(String::as_str).collect()).collect();
        assert_eq!(
            fields,
            [vec!["a", "b, \"c\"", ""], vec!["1", "two\nlines", "3"], vec!["4", "", ""], vec!["5", "open\n6"]]
        );
        assert_eq!(rows.iter().map(|r| r.is_open).collect::<Vec<_>>(), [false, false, false, true]);
    }

    #[test]
    fn names_tell_coordinates() {
        let of = |text: &str| layout(text).map(|l| (l.sign, l.place));
        let numbers = |x, y, z, are_degrees| Some(Place::Numbers { x, y, z, are_degrees });
        for (text, sign, place) in [
            ("name,Longitude,Latitude,elevation\n", ',', numbers(1, 2, Some(3), true)),
            ("Lat;LNG;Name (a, b)\n", ';', numbers(1, 0, None, true)),
            ("id\tEasting\tNorthing\tHeight (m)", '\t', numbers(1, 2, Some(3), false)),
            ("x|y|z", '|', numbers(0, 1, Some(2), false)),
            ("WKT,name", ',', Some(Place::Text(0))),
            ("lon_deg,lat_deg,x,y", ',', numbers(0, 1, None, true)),
            ("a,b,c", ',', None),
        ] {
            assert_eq!(of(text), Some((sign, place)), "{text}");
        }
        assert_eq!(of(""), None);
        assert!(
            has_coordinates("wkt\nPOINT (1 2)")
                && !has_coordinates("geometry of things\n")
                && !has_coordinates("x\n1\n")
        );
    }
}
