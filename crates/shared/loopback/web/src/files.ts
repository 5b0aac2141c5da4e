// What a page loads from its server; paths are relative to the page, so that the token stays in them.

export async function load(path: string, options?: RequestInit): Promise<Response> {
  const answer = await fetch(path, options).catch(() => undefined);
  if (!answer) throw new Error(`${path}: the program that serves this page has stopped; start it again`);
  if (!answer.ok) throw new Error(`${path}: ${(await answer.text()).trim() || answer.statusText}`);
  return answer;
}

export async function json<T>(path: string): Promise<T> {
  return (await load(path)).json();
}

/** Code values of a picture as they stand in the file: no colour profile, no alpha multiplied in. Red, green, blue, alpha. */
export async function codes(path: string): Promise<{ width: number; height: number; data: Uint8ClampedArray }> {
  const blob = await (await load(path)).blob();
  const bitmap = await createImageBitmap(blob, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (!context) throw new Error("this browser draws no pictures; use a current one");
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  return context.getImageData(0, 0, canvas.width, canvas.height);
}
