fn main() {
    piaffe_codegen::Config::new("model-spec").compile();
}
