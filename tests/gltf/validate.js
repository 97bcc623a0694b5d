// node validate.js VALIDATOR FILE...: a line of counts for each glTF file, and what the validator says of it.
// Exit code 1 when a file has an error or a warning.
const fs = require("fs");
const path = require("path");

const [folder, ...files] = process.argv.slice(2);
const validator = require(path.resolve(folder));

async function validate(file) {
  const { issues } = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 0 });
  const kinds = new Map();
  for (const { code, severity, message, pointer } of issues.messages) {
    if (severity > 1) kinds.set(code, (kinds.get(code) ?? 0) + 1);
    else console.log(`${["error", "warning"][severity]} ${code} at ${pointer}: ${message}`);
  }
  const others = [...kinds].map(([code, count]) => `${count} ${code}`).join(", ");
  console.log(`${path.basename(file)}: ${issues.numErrors} errors, ${issues.numWarnings} warnings` +
              (others ? ` (${others})` : ""));
  return issues.numErrors + issues.numWarnings;
}

(async () => {
  let faults = 0;
  for (const file of files) faults += await validate(file);
  process.exit(faults > 0 ? 1 : 0);
})();
