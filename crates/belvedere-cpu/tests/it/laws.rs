//! The contract of renderers.

belvedere_testkit::renderer_laws!(rasteriser, belvedere_cpu::CpuRenderer::default());
belvedere_testkit::renderer_laws!(tracer, belvedere_cpu::ExactRenderer);
belvedere_testkit::renderer_laws!(marcher, belvedere_testkit::synthetic::Marcher { fault: 1.0 });

#[test]
#[should_panic(expected = "pixels show what their rays meet")]
fn depths_that_are_a_hundredth_too_large_are_seen() {
    let planted = belvedere_testkit::synthetic::Marcher { fault: 1.01 };
    belvedere_testkit::laws::renderer::draws_what_a_ray_meets(&planted);
}
