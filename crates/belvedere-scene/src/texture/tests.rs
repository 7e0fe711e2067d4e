use super::*;

const RED: [u8; 4] = [200, 0, 0, 255];
const BLUE: [u8; 4] = [0, 0, 100, 255];

fn two(wrap: Wrap) -> Texture {
    Texture::new(2, 1, vec![RED, BLUE], [wrap; 2]).unwrap()
}

fn color([r, g, b, a]: [u8; 4]) -> Color {
    Color { r, g, b, a }
}

#[test]
fn pixels_have_their_colour_at_their_middle_and_mix_between() {
    let t = two(Wrap::Clamp);
    assert_eq!(t.at(Vec2::new(0.25, 0.5), 1.0), color(RED));
    assert_eq!(t.at(Vec2::new(0.75, 0.5), 0.0), color(BLUE));
    assert_eq!(t.at(Vec2::new(0.5, 0.9), 1.0), Color::rgb(100, 0, 50));
    // Coarser: the mean of the squares.
    assert_eq!(t.at(Vec2::new(0.1, 0.5), 2.0), Color::rgb(141, 0, 71));
    assert_eq!(t.at(Vec2::new(0.1, 0.5), 1e9), Color::rgb(141, 0, 71));
}

#[test]
fn beyond_the_edge() {
    let at = |wrap, u: f32| two(wrap).at(Vec2::new(u, 0.5), 1.0);
    for (wrap, [before, after, far]) in
        [(Wrap::Repeat, [BLUE, RED, RED]), (Wrap::Clamp, [RED, BLUE, BLUE]), (Wrap::Mirror, [RED, BLUE, RED])]
    {
        assert_eq!([at(wrap, -0.25), at(wrap, 1.25), at(wrap, 2.25)], [before, after, far].map(color), "{wrap:?}");
    }
    assert_eq!(two(Wrap::Repeat).at(Vec2::NAN, 1.0), color(RED));
    assert_eq!(two(Wrap::Repeat).at(Vec2::new(1e30, -1e30), f32::NAN).a, 255);
}

#[test]
fn sizes_must_fit() {
    assert!(Texture::new(0, 4, vec![], [Wrap::Repeat; 2]).is_none());
    assert!(Texture::new(2, 2, vec![RED; 3], [Wrap::Repeat; 2]).is_none());
    assert_eq!(Texture::new(5, 3, vec![RED; 15], [Wrap::Repeat; 2]).unwrap().size(), [5, 3]);
}
