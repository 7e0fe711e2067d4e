//! Tests of the processor renderer against slow, independent references.

mod areas;
mod branches;
mod cache;
mod exact;
mod huge_triangles;
mod lines;
mod lod;
mod marks;
mod molecules;
mod own_stage;
mod random_rays;
mod real_data;
mod reference;
mod rigid;
mod robust;
mod sections;
mod see_through;
mod soft_edge;
mod steady;
mod steady_lines;
mod steady_names;
mod strip;
mod subdivision;
mod support;
mod support_views;
mod volume_edges;
