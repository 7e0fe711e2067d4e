//! Errors in the words of the window instead of those of scene files.

/// Keys of scene files that errors name, and what the window calls them.
const WORDS: [(&str, &str); 47] = [
    ("terrain_disocclusion", "ground that makes way"),
    ("ground_moves", "ground moved by hand"),
    ("shift_m", "shift"),
    ("angle_deg", "angle"),
    ("by_m", "height or width"),
    ("core_m", "core"),
    ("from_m", "start of the stretch"),
    ("curved_rays", "curved rays"),
    ("spline_bend", "spline"),
    ("target_tracking", "keeping in sight"),
    ("path_preview", "along a path"),
    ("auto_probe", "into what is hidden"),
    ("fov_y_deg", "field of view"),
    ("look_at", "point looked at"),
    ("must_see", "must be seen"),
    ("heading_deg", "heading"),
    ("pitch_deg", "pitch"),
    ("ortho_height_m", "height of the parallel projection"),
    ("azimuth_deg", "direction of the sun"),
    ("altitude_deg", "height of the sun"),
    ("adjust_viewpoint", "camera or ground"),
    ("rise_limit_m", "rise at most"),
    ("margin_m", "clearance"),
    ("show", "share to show"),
    ("move_at_most_m", "ground moves at most"),
    ("slack_price", "price of what stays hidden"),
    ("solver_nodes", "nodes of the solver"),
    ("position_m", "position along the path"),
    ("preview_m", "length of the preview"),
    ("color_by", "coloured by"),
    ("width_by", "width by"),
    ("size_by", "size by"),
    ("width_px", "width"),
    ("size_px", "size"),
    ("label_px", "height of the letters"),
    ("lift_m", "height over the ground"),
    ("distance_markers_m", "distance marks"),
    ("ambient_occlusion", "ambient occlusion"),
    ("height_m", "height"),
    ("above_ground_m", "height over the ground"),
    ("speed_mps", "speed"),
    ("start_m", "start"),
    ("behind_m", "distance behind the walker"),
    ("above_m", "height over the walker"),
    ("ahead_m", "distance ahead"),
    ("reach_m", "reach"),
    ("grow_px", "growth of the target"),
];

/// The error of a scene that was edited in the window, in its words.
///
/// * `own`: names that the user gave, such as those of layers; they stay as they are.
pub(crate) fn in_window_words(error: &str, own: &[&str]) -> String {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let mut out = String::with_capacity(error.len());
    let mut rest = error;
    while let Some(first) = rest.chars().next() {
        let end = if is_part(first) {
            rest.find(|c: char| !is_part(c)).unwrap_or(rest.len())
        } else {
            rest.find(is_part).unwrap_or(rest.len())
        };
        let (word, after) = rest.split_at(end);
        let known = WORDS.iter().find(|(key, _)| *key == word && !own.contains(&word));
        out.push_str(known.map_or(word, |(_, words)| words));
        rest = after;
    }
    // Tables are written in brackets.
    for (table, words) in [
        ("[camera]", "the camera"),
        ("[constructor]", "the panel of curved rays"),
        ("[[layer]]", "a layer"),
        ("[[stage]]", "a bend"),
        ("[light]", "the light"),
        ("[overlay]", "the marks"),
    ] {
        out = out.replace(table, words);
    }
    let mut letters = out.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_become_words_and_names_stay() {
        let error = "camera has fov_y_deg 190 and no look_at; layer \"gr11_look_at\": width_px is 0; add [constructor]";
        let said = in_window_words(error, &[]);
        assert_eq!(
            said,
            "Camera has field of view 190 and no point looked at; layer \"gr11_look_at\": width is 0; add the panel of curved rays"
        );
        assert_eq!(in_window_words("layer \"look_at\" is hidden", &["look_at"]), "Layer \"look_at\" is hidden");
    }

    #[test]
    fn no_key_with_an_underscore_that_the_window_edits_is_left() {
        let schema = include_str!("../../../docs/scene.schema.json");
        for (key, words) in WORDS {
            assert!(schema.contains(&format!("\"{key}\"")), "{key} is no key of scene files");
            assert!(!words.contains('_'), "{words}");
        }
    }
}
