fn main() {
    piaffe_codegen::Config::new("model-spec").runtime("crate::model").compile();
}
