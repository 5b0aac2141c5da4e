// What the pages ask of the program that serves them.
import { load } from "pages/files";

export { json } from "pages/files";

/** Says something, and waits for the answer. */
export async function send(method: "PUT" | "POST", path: string, body: unknown): Promise<Response> {
  const isBytes = body instanceof Blob;
  const options = { method, body: isBytes ? body : JSON.stringify(body), headers: { "content-type": isBytes ? body.type : "application/json" } };
  return load(path, options);
}

export async function ask<T>(path: string, body: unknown): Promise<T> {
  return (await send("POST", path, body)).json();
}

export interface Need {
  path: string;
  what: string;
  made_by: string;
  is_optional: boolean;
  is_there: boolean;
}

export interface About {
  id: string;
  title: string;
  does: string;
  writes: string;
  next: string;
  needs: Need[];
}

export interface Overview {
  take: string;
  manifest: { take: string; session: string; mesh_unit: string } | null;
  has_run: boolean;
  pages: About[];
}

export interface CameraImages {
  id: string;
  size: [number, number];
  frames: number[];
}

export interface Images {
  take: { take: string; session: string; sha256: string } | null;
  cameras: CameraImages[];
}
