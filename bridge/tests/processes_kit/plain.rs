//! Plain iceoryx2, without the bridge, in a domain of the bridge. See bridge/WIRE.md.

use belvedere_bridge::Domain;
use iceoryx2::{
    node::Node,
    prelude::{
        Config, FileName, NodeBuilder, Path, SemanticString as _, ServiceName, SignalHandlingMode, ipc,
    },
};

/// Creates a node of plain iceoryx2.
pub fn node(domain: &Domain) -> Node<ipc::Service> {
    let mut config = Config::default();
    config.global.prefix = FileName::new(domain.prefix().as_bytes()).unwrap();
    let directory = domain.directory();
    config.global.set_root_path(&Path::new(directory.as_os_str().as_encoded_bytes()).unwrap());
    NodeBuilder::new()
        .config(&config)
        .signal_handling_mode(SignalHandlingMode::Disabled)
        .create::<ipc::Service>()
        .unwrap()
}

/// Returns the name of a stream in iceoryx2.
pub fn service(topic: &str) -> ServiceName {
    ServiceName::new(&format!("belvedere/{topic}")).unwrap()
}
