"""Requests to the page's server without a network."""

import asyncio
from typing import Any

import httpx


class AsgiClient:
    """Sends requests to an application, one after the other, as `http://localhost`."""

    def __init__(self, application: Any) -> None:
        self._transport = httpx.ASGITransport(application)

    def request(self, method: str, address: str, **options: Any) -> httpx.Response:
        """Send a request, wait for its answer."""

        async def sent() -> httpx.Response:
            async with httpx.AsyncClient(transport=self._transport, base_url="http://localhost") as client:
                return await client.request(method, address, **options)

        return asyncio.run(sent())

    def get(self, address: str, **options: Any) -> httpx.Response:
        """Get something."""
        return self.request("GET", address, **options)

    def post(self, address: str, **options: Any) -> httpx.Response:
        """Change something."""
        return self.request("POST", address, **options)
