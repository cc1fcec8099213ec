fn main() {
    piaffe_codegen::Config::new("model-spec").runtime("piaffe_model").compile();
}
