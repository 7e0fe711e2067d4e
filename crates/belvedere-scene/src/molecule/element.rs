//! Elements: symbols, radii, colours.

use crate::Color;

/// An element by its atomic number; unknown where a file names none that exists, as for the massless sites of water models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct Element(u8);

/// Symbol, covalent radius and van der Waals radius in picometres, by atomic number from 1.
///
/// Covalent radii: Cordero et al. 2008 (sp3 carbon, low-spin metals). Van der Waals radii: Bondi 1964, for main-group elements that he
/// does not list Mantina et al. 2009; 200 where neither has one.
#[rustfmt::skip]
const TABLE: [(&str, u16, u16); 96] = [
    ("H", 31, 120), ("He", 28, 140), ("Li", 128, 182), ("Be", 96, 153), ("B", 84, 192), ("C", 76, 170),
    ("N", 71, 155), ("O", 66, 152), ("F", 57, 147), ("Ne", 58, 154), ("Na", 166, 227), ("Mg", 141, 173),
    ("Al", 121, 184), ("Si", 111, 210), ("P", 107, 180), ("S", 105, 180), ("Cl", 102, 175), ("Ar", 106, 188),
    ("K", 203, 275), ("Ca", 176, 231), ("Sc", 170, 200), ("Ti", 160, 200), ("V", 153, 200), ("Cr", 139, 200),
    ("Mn", 139, 200), ("Fe", 132, 200), ("Co", 126, 200), ("Ni", 124, 163), ("Cu", 132, 140), ("Zn", 122, 139),
    ("Ga", 122, 187), ("Ge", 120, 211), ("As", 119, 185), ("Se", 120, 190), ("Br", 120, 185), ("Kr", 116, 202),
    ("Rb", 220, 303), ("Sr", 195, 249), ("Y", 190, 200), ("Zr", 175, 200), ("Nb", 164, 200), ("Mo", 154, 200),
    ("Tc", 147, 200), ("Ru", 146, 200), ("Rh", 142, 200), ("Pd", 139, 163), ("Ag", 145, 172), ("Cd", 144, 158),
    ("In", 142, 193), ("Sn", 139, 217), ("Sb", 139, 206), ("Te", 138, 206), ("I", 139, 198), ("Xe", 140, 216),
    ("Cs", 244, 343), ("Ba", 215, 268), ("La", 207, 200), ("Ce", 204, 200), ("Pr", 203, 200), ("Nd", 201, 200),
    ("Pm", 199, 200), ("Sm", 198, 200), ("Eu", 198, 200), ("Gd", 196, 200), ("Tb", 194, 200), ("Dy", 192, 200),
    ("Ho", 192, 200), ("Er", 189, 200), ("Tm", 190, 200), ("Yb", 187, 200), ("Lu", 187, 200), ("Hf", 175, 200),
    ("Ta", 170, 200), ("W", 162, 200), ("Re", 151, 200), ("Os", 144, 200), ("Ir", 141, 200), ("Pt", 136, 175),
    ("Au", 136, 166), ("Hg", 132, 155), ("Tl", 145, 196), ("Pb", 146, 202), ("Bi", 148, 207), ("Po", 140, 197),
    ("At", 150, 202), ("Rn", 150, 220), ("Fr", 260, 348), ("Ra", 221, 283), ("Ac", 215, 200), ("Th", 206, 200),
    ("Pa", 200, 200), ("U", 196, 186), ("Np", 190, 200), ("Pu", 187, 200), ("Am", 180, 200), ("Cm", 169, 200),
];

/// Colours by the convention of Corey, Pauling and Koltun: carbon grey, nitrogen blue, oxygen red, hydrogen white, phosphorus
/// orange, sulphur yellow; the shades are ours.
const COLORS: [(&str, Color); 17] = [
    ("H", Color::rgb(238, 238, 236)),
    ("C", Color::rgb(132, 136, 142)),
    ("N", Color::rgb(66, 104, 214)),
    ("O", Color::rgb(214, 56, 48)),
    ("F", Color::rgb(142, 206, 96)),
    ("Na", Color::rgb(148, 98, 200)),
    ("Mg", Color::rgb(92, 160, 62)),
    ("P", Color::rgb(236, 140, 36)),
    ("S", Color::rgb(228, 196, 52)),
    ("Cl", Color::rgb(82, 182, 84)),
    ("K", Color::rgb(132, 78, 184)),
    ("Ca", Color::rgb(110, 150, 90)),
    ("Mn", Color::rgb(150, 110, 176)),
    ("Fe", Color::rgb(196, 98, 50)),
    ("Cu", Color::rgb(190, 122, 74)),
    ("Zn", Color::rgb(118, 122, 168)),
    ("Br", Color::rgb(154, 64, 48)),
];

/// Colours of all other elements, and of unknown ones.
const METAL: Color = Color::rgb(176, 146, 166);
const UNKNOWN: Color = Color::rgb(204, 150, 190);

/// Elements whose ions sit among their neighbours without a covalent bond: the alkali and alkaline earth metals.
const IONIC: [&str; 11] = ["Li", "Na", "K", "Rb", "Cs", "Fr", "Mg", "Ca", "Sr", "Ba", "Ra"];

impl Element {
    /// No element.
    pub const UNKNOWN: Self = Self(0);
    /// Hydrogen.
    pub const H: Self = Self(1);
    /// Carbon.
    pub const C: Self = Self(6);
    /// Nitrogen.
    pub const N: Self = Self(7);
    /// Oxygen.
    pub const O: Self = Self(8);
    /// Phosphorus.
    pub const P: Self = Self(15);

    /// The element of a symbol in any case; deuterium is hydrogen. `None` for an unknown symbol.
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        if symbol.eq_ignore_ascii_case("D") {
            return Some(Self::H);
        }
        let at = TABLE.iter().position(|(s, ..)| s.eq_ignore_ascii_case(symbol))?;
        Some(Self(at as u8 + 1))
    }

    /// The element of an atomic number; `None` for one that there is not.
    pub fn from_number(number: usize) -> Option<Self> {
        (1..=TABLE.len()).contains(&number).then_some(Self(number as u8))
    }

    fn row(self) -> Option<&'static (&'static str, u16, u16)> {
        TABLE.get(usize::from(self.0).checked_sub(1)?)
    }

    /// Its symbol; `X` for an unknown one.
    pub fn symbol(self) -> &'static str {
        self.row().map_or("X", |r| r.0)
    }

    /// Covalent radius, angstrom; 0 for an unknown element, which forms no bonds by distance.
    pub fn covalent_radius(self) -> f64 {
        self.row().map_or(0.0, |r| f64::from(r.1) / 100.0)
    }

    /// Van der Waals radius, angstrom; 0 for an unknown element, which is not drawn.
    pub fn van_der_waals_radius(self) -> f64 {
        self.row().map_or(0.0, |r| f64::from(r.2) / 100.0)
    }

    /// Whether it bonds by sharing electrons, so that near neighbours are bonded to it.
    pub fn shares_electrons(self) -> bool {
        self.row().is_some_and(|r| !IONIC.contains(&r.0))
    }

    /// Its colour.
    pub fn color(self) -> Color {
        let Some((symbol, ..)) = self.row() else { return UNKNOWN };
        COLORS.iter().find(|(s, _)| s == symbol).map_or(METAL, |(_, c)| *c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_and_radii() {
        for (i, (symbol, covalent, vdw)) in TABLE.iter().enumerate() {
            let e = Element::from_symbol(&symbol.to_uppercase()).unwrap();
            assert_eq!((e.0 as usize, e.symbol()), (i + 1, *symbol));
            // A bond is shorter than two atoms that only touch, but for uranium.
            assert!(covalent < vdw || *vdw == 200 || *symbol == "U", "{symbol}");
            assert!((28..=350).contains(covalent) && (120..=350).contains(vdw), "{symbol}");
        }
        assert_eq!([1, 6, 7, 8, 15].map(|z| Element(z).symbol()), ["H", "C", "N", "O", "P"]);
        assert_eq!((Element(26).symbol(), Element(79).symbol(), Element(92).symbol()), ("Fe", "Au", "U"));
        assert_eq!(Element::from_symbol("D"), Some(Element::H));
        assert_eq!((Element::from_symbol("Xx"), Element::from_symbol("")), (None, None));
        assert_eq!((Element::UNKNOWN.symbol(), Element::UNKNOWN.van_der_waals_radius()), ("X", 0.0));
    }
}
