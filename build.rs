fn main() {
    piaffe_codegen::Config::new("model-spec/robot.toml")
        .gait("model-spec/gaits/trot.toml")
        .gait("model-spec/gaits/amble.toml")
        .gait("model-spec/gaits/curvet.toml")
        .runtime("crate::model")
        .compile();
}
