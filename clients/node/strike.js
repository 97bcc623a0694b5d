// Strike an object of a running ringdownd from Node.js, with the package osc:
//
//     npm install osc@2.4.5 --omit=optional --ignore-scripts
//     node strike.js bell            (RINGDOWN_PORT names another port than 7770)
//
// Units are SI; points and impulses are in the object's own frame. docs/reference/protocol.md lists every address.
const osc = require("osc");

const object = process.argv[2] || "bell";
const remotePort = Number(process.env.RINGDOWN_PORT || 7770);
const port = new osc.UDPPort({ localAddress: "127.0.0.1", localPort: 0, remoteAddress: "127.0.0.1", remotePort });
const numbers = (...values) => values.map((value) => ({ type: "f", value }));

port.on("message", (message) => {
  if (message.address === "/fail") console.error(message.args[1]);
  process.exit(message.address === "/fail" ? 1 : 0);
});

port.on("ready", () => {
  const strike = numbers(0.05, 0, 0.02, -0.02, 0, 0, 0.0005);
  port.send({ address: `/object/${object}/strike`, args: strike });

  // A second strike exactly 300 ms from now: a bundle with a time tag.
  const later = { address: `/object/${object}/strike`, args: strike };
  port.send({ timeTag: osc.timeTag(0.3), packets: [later] });

  port.send({ address: "/sync", args: [{ type: "i", value: 1 }] });
});

port.open();
setTimeout(() => {
  console.error(`no daemon answers on port ${remotePort}: start ringdownd first`);
  process.exit(1);
}, 2000);
