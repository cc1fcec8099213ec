fn main() {
    piaffe_codegen::Config::new("model-spec").functions_only().compile();
}
