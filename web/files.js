// Files that the user chooses or saves.

/** The bytes of a file, unless it has more than `most`: then it may not fit into the memory. */
export async function bytesOf(file, most) {
  if (file.size > most) throw new Error(`the size is ${Math.round(file.size / 2 ** 20)} MB, and the limit is ${most / 2 ** 20} MB`);
  return new Uint8Array(await file.arrayBuffer());
}

/** Lets the user choose a file with one of these extensions and at most so many bytes; answers null if they choose none. */
export function chooseFile(extensions, most) {
  const input = document.createElement("input");
  input.type = "file";
  input.accept = extensions.map((extension) => `.${extension}`).join(",");
  return new Promise((resolve, reject) => {
    input.addEventListener("cancel", () => resolve(null));
    input.addEventListener("change", async () => {
      const file = input.files[0];
      if (!file) return resolve(null);
      try {
        resolve({ name: file.name, bytes: await bytesOf(file, most) });
      } catch (error) {
        reject(Object.assign(error, { fileName: file.name }));
      }
    });
    input.click();
  });
}

/** Lets the user save bytes under a name. */
export function saveFile(name, bytes) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([bytes]));
  link.download = name;
  link.click();
  // The download has begun by then and holds the bytes itself.
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

/** Lets the user save an SVG as a PNG of this size in pixels. The browser draws it: no renderer has to be downloaded. */
export async function savePicture(name, svg, width, height) {
  const image = new Image(width, height);
  image.src = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
  try {
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [width, height];
    canvas.getContext("2d").drawImage(image, 0, 0, width, height);
    const picture = await new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
    if (!picture) throw new Error("the picture is too large for this browser");
    saveFile(name, picture);
  } finally {
    URL.revokeObjectURL(image.src);
  }
}
