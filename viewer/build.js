// Bundles the page into dist/, which is committed, because cargo alone builds the program; or into the folder that is
// given: node build.js FOLDER
import { build } from "esbuild";
import { copyFile, mkdir } from "node:fs/promises";

const folder = process.argv[2] ?? "dist";
await mkdir(folder, { recursive: true });
await build({
  entryPoints: ["src/viewer.ts"],
  outfile: `${folder}/viewer.js`,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "eof",
});
for (const name of ["index.html", "viewer.css", "favicon.svg"]) {
  await copyFile(`src/${name}`, `${folder}/${name}`);
}
