fn main() {
    // The legs of the A1 do not share their links, so its gait is not affine in their numbers.
    piaffe_codegen::Config::new("model-spec")
        .without("a1")
        .parameter("gravity")
        .parameter("links")
        .parameter("legs")
        .parameter("actuators")
        .compile();
}
