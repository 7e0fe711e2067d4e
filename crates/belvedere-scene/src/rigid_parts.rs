//! Which parts of a mesh are rigid.

/// Which parts of a mesh are rigid bodies.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum RigidParts {
    /// None: every point is displaced by itself.
    #[default]
    None,
    /// Every part ([`crate::Mesh::part`]); a mesh without parts as a whole.
    All,
    /// These parts, by their numbers.
    Only(Vec<u32>),
}
