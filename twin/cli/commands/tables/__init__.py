"""Commands about tables: tool libraries, materials, schemas."""
