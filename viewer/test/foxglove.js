// Tests the server with Lichtblick's own client code: channels, messages, time, parameters, velocities.
import assert from "node:assert/strict";
import protocol from "@foxglove/ws-protocol";
import rosmsg from "@lichtblick/rosmsg";
import serialization from "@lichtblick/rosmsg-serialization";
import { WebSocket } from "ws";
import { end, killAll, start, until } from "./simulator.js";

// These packages are CommonJS.
const { FoxgloveClient } = protocol;
const { parse } = rosmsg;
const { MessageReader, MessageWriter } = serialization;

/** The table of schemas that a connection is sent with `foxglove.sdk.v1.1`, by number; each is sent once. */
function tableOf(connection) {
  const schemas = new Map();
  connection.on("message", (data, isBinary) => {
    const told = isBinary ? {} : JSON.parse(data);
    for (const schema of told.op === "advertise" ? (told.schemas ?? []) : []) {
      assert.ok(!schemas.has(schema.id) && ![...schemas.values()].some(({ name }) => name === schema.name), schema.name);
      schemas.set(schema.id, schema);
    }
  });
  return schemas;
}

try {
  const simulator = await start(`foxglove-${process.pid}`, 0, [
    "--robot", "kobuki_hexagons_kinect", "--world", "playground", "--drive", "still",
  ]);
  const socket = (protocols) => new WebSocket(simulator.url.replace("http:", "ws:"), protocols);
  for (const name of ["foxglove.websocket.v1", "foxglove.sdk.v1", "foxglove.sdk.v1.1"]) {
    const connection = socket([name]);
    const table = tableOf(connection);
    const client = new FoxgloveClient({ ws: connection });
    const [channels, readers, messages] = [new Map(), new Map(), new Map()];
    let [info, now, parameters, error] = [null, 0n, null, null];
    client.on("error", (reason) => (error = reason));
    client.on("serverInfo", (event) => (info = event));
    client.on("advertise", (added) => {
      for (const { schemaId, ...channel } of added) {
        // The client does not support the table, so the schema is copied into the channel.
        const { name: schemaName, data: schema } = table.get(schemaId) ?? {};
        channels.set(channel.topic, schemaId === undefined ? channel : { ...channel, schemaName, schema });
      }
    });
    client.on("time", (event) => (now = event.timestamp));
    client.on("parameterValues", (event) => (parameters = event.parameters));
    client.on("message", ({ subscriptionId, data, timestamp }) => {
      const reader = readers.get(subscriptionId);
      messages.set(reader.topic, { ...reader.reader.readMessage(data), timestamp });
    });
    await until("channels", () => channels.has("/tf_static") && channels.has("/camera/rgb/image_raw"));
    assert.deepEqual(info.supportedEncodings, ["ros1", "json"]);
    assert.equal(table.size > 5, name === "foxglove.sdk.v1.1");
    const topics = [
      "/camera/rgb/image_raw", "/camera/depth/points", "/camera/rgb/camera_info", "/tf", "/tf_static", "/odom",
      "/joint_states", "/gazebo/link_states",
    ];
    for (const topic of topics) {
      const { id, schema, schemaName, encoding } = channels.get(topic);
      assert.equal(encoding, "ros1");
      const reader = new MessageReader(parse(schema));
      readers.set(client.subscribe(id), { topic, reader, schemaName });
    }
    await until("a message of each", () => topics.every((topic) => messages.has(topic)));
    const image = messages.get("/camera/rgb/image_raw");
    assert.deepEqual([image.width, image.height, image.encoding, image.data.length], [640, 480, "rgb8", 921600]);
    assert.equal(image.timestamp, BigInt(image.header.stamp.sec) * 1000000000n + BigInt(image.header.stamp.nsec));
    assert.ok(messages.get("/tf_static").transforms.length > 5);
    const before = now;
    await until("time", () => now > before);
    client.getParameters([], "all");
    await until("parameters", () => parameters);
    const value = (name) => parameters.find((parameter) => parameter.name === name)?.value;
    assert.match(value("/robot_description"), /<robot[\s\S]*base_link/);
    assert.equal(value("/use_sim_time"), true);

    // Velocity commands in both encodings.
    for (const encoding of ["ros1", "json"]) {
      const channel = client.advertise({ topic: "/cmd_vel", encoding, schemaName: "geometry_msgs/Twist" });
      const twist = { linear: { x: 0.3, y: 0, z: 0 }, angular: { x: 0, y: 0, z: 0 } };
      const schema = "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n" + "=".repeat(80) +
        "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z";
      const data = encoding === "json"
        ? new TextEncoder().encode(JSON.stringify(twist))
        : new MessageWriter(parse(schema)).writeMessage(twist);
      const speed = () => messages.get("/odom").twist.twist.linear.x;
      await until(`it goes by ${encoding}`, () => (client.sendMessage(channel, data), speed() > 0.1));
      client.unadvertise(channel);
      await until("it stands", () => Math.abs(speed()) < 0.02);
    }
    for (const id of readers.keys()) client.unsubscribe(id);
    assert.equal(error, null);
    client.close();
    console.log(`${name}: ${topics.length} topics, time, parameters, velocities`);
  }
  const refused = socket(["foxglove.of-the-future"]);
  await new Promise((resolve) => refused.once("error", resolve));
  await end(simulator);
} finally {
  killAll();
}
