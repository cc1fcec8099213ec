fn main() {
    piaffe_codegen::Config::new("../model-spec")
        .parameter("gravity")
        .parameter("links")
        .parameter("legs")
        .parameter("actuators")
        .compile();
}
