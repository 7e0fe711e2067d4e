//! Compares measurements of the collection with earlier ones.

use crate::over_collection::{CollectionReport, SceneCost};

/// Growth of a ratio that counts as slower.
const SLOWER: f64 = 1.15;

/// A ratio that a scene has, by name.
type Ratio = (&'static str, fn(&SceneCost) -> Option<f64>);

const RATIOS: [Ratio; 4] = [
    ("straight to yardstick", |cost| Some(cost.to_yardstick)),
    ("bent to straight", |cost| Some(cost.bent_to_straight)),
    ("moving to straight", |cost| Some(cost.moving_to_straight)),
    ("straight to VTK", |cost| cost.to_vtk),
];

impl CollectionReport {
    /// What became slower than in an earlier report: ratios that are more than 1.15 times those, one line each. Times are not compared, for
    /// machines differ.
    pub fn slower_than(&self, earlier: &Self) -> Vec<String> {
        let mut lines = Vec::new();
        for cost in &self.scenes {
            let Some(before) = earlier.scenes.iter().find(|before| before.scene == cost.scene) else { continue };
            for (name, ratio) in RATIOS {
                if let (Some(now), Some(then)) = (ratio(cost), ratio(before))
                    && now > SLOWER * then
                {
                    lines.push(format!("{}: {name} {now:.2}, was {then:.2} ({:.2} times)", cost.scene, now / then));
                }
            }
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(bent_to_straight: f64, to_vtk: Option<f64>) -> CollectionReport {
        let cost = SceneCost {
            scene: "a".into(),
            bend: "earth".into(),
            triangles: 1,
            straight_ms: 10.0,
            to_yardstick: 1.0,
            bent_ms: 10.0 * bent_to_straight,
            bent_to_straight,
            moving_ms: 1.0,
            moving_to_straight: 0.1,
            pixels_exponent: 1.0,
            vtk_ms: None,
            to_vtk,
        };
        CollectionReport {
            program: String::new(),
            processor: String::new(),
            threads: 1,
            clock: String::new(),
            load: [None; 2],
            image: [1, 1],
            rounds: 1,
            vtk: None,
            scenes: vec![cost],
            slower: Vec::new(),
        }
    }

    #[test]
    fn only_ratios_that_grew_by_more_than_a_seventh_are_told() {
        let before = report(1.0, Some(0.5));
        assert!(report(1.14, None).slower_than(&before).is_empty());
        assert_eq!(report(1.2, Some(0.5)).slower_than(&before), ["a: bent to straight 1.20, was 1.00 (1.20 times)"]);
        assert_eq!(report(0.5, Some(0.6)).slower_than(&before), ["a: straight to VTK 0.60, was 0.50 (1.20 times)"]);
        assert!(report(2.0, None).slower_than(&CollectionReport { scenes: Vec::new(), ..before }).is_empty());
    }
}
