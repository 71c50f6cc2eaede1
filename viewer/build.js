// Bundles the page into dist/, which is committed: cargo alone builds the program.
import { build } from "esbuild";
import { copyFile, mkdir } from "node:fs/promises";

await mkdir("dist", { recursive: true });
await build({
  entryPoints: ["src/viewer.ts"],
  outfile: "dist/viewer.js",
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "eof",
});
for (const name of ["index.html", "viewer.css", "favicon.svg"]) {
  await copyFile(`src/${name}`, `dist/${name}`);
}
